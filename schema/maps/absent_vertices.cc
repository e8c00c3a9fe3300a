#include "schema/maps/absent_vertices.h"

#include <utility>

namespace mapweld {
namespace {

void append(const Reader& db, MapId map, VertexId first, std::uint32_t count, std::vector<VertexId>& vertices) {
  sqlite::Statement row = db.prepare(
      "SELECT vertex FROM images INDEXED BY images_deleted "
      "WHERE map = ?1 AND vertex >= ?2 AND vertex < ?3 AND deleted_at_us IS NOT NULL "
      "UNION ALL SELECT vertex FROM purged_vertices WHERE map = ?1 AND vertex >= ?2 AND vertex < ?3 ORDER BY 1");
  const std::uint64_t begin = to_index(first);
  row.bind_all(map, begin, begin + count);
  while (row.step()) vertices.push_back(row.id<VertexId>(0));
}

}  // namespace

VertexSet absent_vertices(const Reader& db, MapId map, VertexId first, std::uint32_t count) {
  std::vector<VertexId> vertices;
  append(db, map, first, count, vertices);
  return VertexSet(std::move(vertices));
}

VertexSet absent_vertices(const Reader& db, const MapLayout& layout) {
  std::vector<VertexId> vertices;
  for (const MapLayout::LeafSpan& span : layout.leaf_spans()) {
    const std::size_t before = vertices.size();
    append(db, span.leaf, span.leaf_first, span.count, vertices);
    for (std::size_t i = before; i < vertices.size(); ++i) {
      vertices[i] = VertexId{to_index(vertices[i]) - to_index(span.leaf_first) + to_index(span.first)};
    }
  }
  return VertexSet(std::move(vertices));
}

VertexSet purged_vertices(const Reader& db, MapId map) {
  std::vector<VertexId> vertices;
  sqlite::Statement row = db.prepare("SELECT vertex FROM purged_vertices WHERE map = ? ORDER BY vertex");
  row.bind(1, map);
  while (row.step()) vertices.push_back(row.id<VertexId>(0));
  return VertexSet(std::move(vertices));
}

}  // namespace mapweld
