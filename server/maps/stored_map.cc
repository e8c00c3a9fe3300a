#include "server/maps/stored_map.h"

#include <algorithm>

#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_store.h"

namespace mapweld::server {

StoredMap::StoredMap(Store& store, MapId map, VocabularyId vocabulary)
    : db_(store.read()), map_(map), vocabulary_(vocabulary), segments_(db_, load_layout(db_, map), vocabulary) {}

void StoredMap::visit(WordId word, VertexId first, VertexId end, const Visitor& visitor) const {
  // A plain map is shown in one piece, with its own numbers.
  segments_.visit(word, [&](const PostingSource::Piece& piece) {
    const PostingSpan part = piece.postings.between(first, end);
    if (!part.empty()) visitor(part);
  });
}

std::shared_ptr<const AppearanceVector> StoredMap::appearances(VertexId vertex) const {
  return std::make_shared<const AppearanceVector>(load_appearances(db_, map_, vocabulary_, vertex));
}

void StoredMap::neighbours(VertexId vertex, std::vector<VertexId>& out) const {
  for (const EdgeRow& edge : list_own_edges_at(db_, map_, vertex)) {
    if (edge.confirmed) out.push_back(edge.u == vertex ? edge.v : edge.u);
  }
}

void StoredMap::linked(VertexId vertex, std::vector<VertexId>& out) const {
  for (const EdgeRow& edge : list_own_edges_at(db_, map_, vertex)) out.push_back(edge.u == vertex ? edge.v : edge.u);
}

}  // namespace mapweld::server
