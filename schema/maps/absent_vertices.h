// Vertices of which nothing shows any more: deleted ones, whose image may be restored, and purged ones, of which only
// the number is left (vertex_removal.h).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/types.h"
#include "schema/maps/map_layout.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// Vertices of one map, ascending, each once.
class VertexSet {
 public:
  VertexSet() = default;
  explicit VertexSet(std::vector<VertexId> ascending) : vertices_(std::move(ascending)) {}
  bool contains(VertexId vertex) const { return std::ranges::binary_search(vertices_, vertex); }
  bool empty() const { return vertices_.empty(); }
  std::size_t size() const { return vertices_.size(); }
  const std::vector<VertexId>& vertices() const { return vertices_; }
  friend bool operator==(const VertexSet&, const VertexSet&) = default;

 private:
  std::vector<VertexId> vertices_;
};

// Of the vertices [first, first + count) of a plain map those that are deleted or purged.
VertexSet absent_vertices(const Reader& db, MapId map, VertexId first, std::uint32_t count);
// The same of all that a map of any kind shows, in its numbers.
VertexSet absent_vertices(const Reader& db, const MapLayout& layout);
// Of a plain map, those that are purged.
VertexSet purged_vertices(const Reader& db, MapId map);

}  // namespace mapweld
