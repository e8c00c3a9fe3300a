// A map as localization and mapping read it, wherever it is kept.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/retrieval/inverted_index.h"
#include "core/types.h"

namespace mapweld {

class MapView {
 public:
  virtual ~MapView() = default;
  virtual const PostingSource& postings() const = 0;
  // The appearance vector of a vertex. Thread-safe. Throws on I/O errors of a store behind it.
  virtual std::shared_ptr<const AppearanceVector> appearances(VertexId v) const = 0;
  // Hop distance between two vertices when it is at most `at_most`, else nullopt.
  virtual std::optional<int> hops(VertexId u, VertexId v, int at_most) const = 0;
  // The vertices that `v` was verified with, whatever is thought of the edges now.
  virtual std::vector<VertexId> linked(VertexId v) const = 0;
};

}  // namespace mapweld
