// A plain map that is too large for memory, or not there yet, read from the store as it is asked for.
#pragma once

#include <memory>

#include "schema/segments/segment_store.h"
#include "schema/store.h"
#include "server/maps/leaf_source.h"

namespace mapweld::server {

// Sees the state that was committed when it was made. Belongs to one thread; keep it no longer than a request.
class StoredMap final : public LeafSource {
 public:
  StoredMap(Store& store, MapId map, VocabularyId vocabulary);

  void visit(WordId word, VertexId first, VertexId end, const Visitor& visitor) const override;
  std::shared_ptr<const AppearanceVector> appearances(VertexId vertex) const override;
  void neighbours(VertexId vertex, std::vector<VertexId>& out) const override;
  void linked(VertexId vertex, std::vector<VertexId>& out) const override;

 private:
  ReadTransaction db_;
  MapId map_;
  VocabularyId vocabulary_;
  SegmentPostingSource segments_;
};

}  // namespace mapweld::server
