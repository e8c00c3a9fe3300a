#include "server/maps/stored_map.h"

#include <algorithm>

#include "schema/edge_store.h"
#include "schema/map_layout.h"
#include "schema/vertex_store.h"

namespace mapweld::server {

StoredMap::StoredMap(Store& store, MapId map, VocabularyId vocabulary)
    : db_(store.read()), map_(map), vocabulary_(vocabulary), segments_(db_, load_layout(db_, map), vocabulary) {}

void StoredMap::postings(WordId word, VertexId first, VertexId end, std::vector<Posting>& out) const {
  std::vector<Posting> all;
  segments_.postings(word, all);
  std::copy_if(all.begin(), all.end(), std::back_inserter(out),
               [&](const Posting& posting) { return posting.vertex >= first && posting.vertex < end; });
}

std::shared_ptr<const AppearanceVector> StoredMap::appearances(VertexId vertex) const {
  return std::make_shared<const AppearanceVector>(load_appearances(db_, map_, vocabulary_, vertex));
}

void StoredMap::neighbours(VertexId vertex, std::vector<VertexId>& out) const {
  for (const EdgeRow& edge : list_own_edges_at(db_, map_, vertex)) {
    if (edge.confirmed) out.push_back(edge.u == vertex ? edge.v : edge.u);
  }
}

}  // namespace mapweld::server
