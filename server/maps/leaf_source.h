// What is read of a plain map to vote, verify and measure hops in it, wherever it is kept.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/retrieval/postings.h"
#include "core/types.h"

namespace mapweld::server {

// Vertices never change once a map has them, so whoever reads only those below a number that he knows to be there sees
// one consistent state, whatever is added meanwhile.
class LeafSource {
 public:
  virtual ~LeafSource() = default;

  // Shows the postings of `word` of the vertices [first, end), ascending, in one piece, if there are any. It is valid
  // while it is visited.
  using Visitor = std::function<void(const PostingSpan&)>;
  virtual void visit(WordId word, VertexId first, VertexId end, const Visitor& visitor) const = 0;
  // Throws std::out_of_range when the map has no such vertex (any more), StoreError when it cannot be read.
  virtual std::shared_ptr<const AppearanceVector> appearances(VertexId vertex) const = 0;
  // Appends the vertices that share a confirmed edge with `vertex`.
  virtual void neighbours(VertexId vertex, std::vector<VertexId>& out) const = 0;
  // Appends those that share any edge with it.
  virtual void linked(VertexId vertex, std::vector<VertexId>& out) const = 0;
};

}  // namespace mapweld::server
