#include "schema/maps/vertex_removal.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "schema/maps/absent_vertices.h"
#include "schema/maps/map_layout.h"
#include "schema/rows.h"

namespace mapweld {
namespace {

// All but the checksum, in the order of the tables.
constexpr std::string_view kColumns =
    "id, map, u, v, votes, matches, inliers, log10_false_alarms, evidence, verifier, confirmed, doubt, job, "
    "verifications, elapsed_s, confidence, judgement";

std::string checksum_in(const std::string& table) {
  return "mapweld_checksum('" + table + "', " + std::string(kColumns) + ")";
}

// Moves one edge from a table to the other. The INSERT has to say the checksum (row_checksums.h): the old one, with
// what the tables' names make of it, so that a damaged row is as damaged where it arrives.
class EdgeMover {
 public:
  EdgeMover(const Reader& db, const std::string& from, const std::string& to)
      : copy_(db.prepare("INSERT INTO " + to + " (" + std::string(kColumns) + ", checksum) SELECT " +
                         std::string(kColumns) + ", mapweld_xor(checksum, " + checksum_in(from) + ", " +
                         checksum_in(to) + ") FROM " + from + " WHERE id = ?")),
        remove_(db.prepare("DELETE FROM " + from + " WHERE id = ?")) {}
  void move(EdgeId edge) {
    copy_.bind(1, edge).run();
    remove_.bind(1, edge).run();
  }

 private:
  sqlite::Statement copy_, remove_;
};

struct EndedEdge {
  EdgeId id{};
  VertexId other{};  // end
  bool confirmed = true;
};

// The edges of a map in `table` at one of its vertices.
std::vector<EndedEdge> edges_at(const Reader& db, const std::string& table, MapId map, VertexId vertex) {
  std::vector<EndedEdge> edges;
  for (const std::string& end :
       {"SELECT id, v, confirmed FROM " + table + " WHERE map = ? AND u = ?",
        "SELECT id, u, confirmed FROM " + table + " INDEXED BY " + table + "_by_later_end WHERE map = ? AND v = ?"}) {
    sqlite::Statement row = db.prepare(end);
    row.bind_all(map, vertex);
    while (row.step()) edges.push_back({row.id<EdgeId>(0), row.id<VertexId>(1), row.integer(2) != 0});
  }
  return edges;
}

// A map that shows vertices of the plain one, which may be itself, with the numbers that it gives them.
struct Showing {
  MapId map{};
  MapLayout layout;
  std::vector<VertexId> vertices;
};

std::vector<Showing> maps_showing(const Reader& db, MapId plain, const std::vector<VertexId>& vertices) {
  std::vector<MapId> maps = {plain};
  for (const MapRow& merged : list_all_merged_over(db, plain)) maps.push_back(merged.id);
  std::vector<Showing> showing;
  for (const MapId map : maps) {
    Showing& one = showing.emplace_back(Showing{map, load_layout(db, map), {}});
    const auto node = std::ranges::find(one.layout.nodes(), plain, &LayoutNode::map);
    for (const VertexId vertex : vertices) {
      if (const auto number = node->number(vertex)) one.vertices.push_back(*number);
    }
    if (one.vertices.empty()) showing.pop_back();
  }
  return showing;
}

// Counts edges that a map has more, or less. That a plain map's edges changed is seen by merged maps in `judgements`.
void count_change(WriteTransaction& db, MapId map, std::int64_t edges, std::int64_t unconfirmed) {
  db.prepare(
        "UPDATE maps SET edges = edges + ?2, unconfirmed = unconfirmed + ?3, revision = revision + 1, "
        "judgements = judgements + 1 WHERE id = ?1")
      .bind_all(map, edges, unconfirmed)
      .run();
}

}  // namespace

VertexStanding standing_of(const Reader& db, MapId map, VertexId vertex) {
  sqlite::Statement image = db.prepare("SELECT deleted_at_us IS NOT NULL FROM images WHERE map = ? AND vertex = ?");
  if (image.bind_all(map, vertex).step()) {
    return image.integer(0) != 0 ? VertexStanding::kDeleted : VertexStanding::kThere;
  }
  sqlite::Statement purged = db.prepare("SELECT 1 FROM purged_vertices WHERE map = ? AND vertex = ?");
  return purged.bind_all(map, vertex).step() ? VertexStanding::kPurged : VertexStanding::kNeverGiven;
}

std::uint64_t delete_vertices(WriteTransaction& db, MapId map, VertexId first, std::uint64_t count, Timestamp now) {
  std::vector<VertexId> vertices;
  {
    sqlite::Statement row = db.prepare(
        "UPDATE images SET deleted_at_us = ?4 WHERE map = ?1 AND vertex >= ?2 AND vertex < ?3 "
        "AND deleted_at_us IS NULL RETURNING vertex");
    const std::uint64_t begin = to_index(first);
    row.bind_all(map, begin, begin + count, rows::microseconds(now));
    while (row.step()) vertices.push_back(row.id<VertexId>(0));
  }
  if (vertices.empty()) return 0;
  std::ranges::sort(vertices);
  EdgeMover mover(db, "edges", "deleted_edges");
  for (const Showing& showing : maps_showing(db, map, vertices)) {
    std::int64_t moved = 0, unconfirmed = 0;
    for (const VertexId vertex : showing.vertices) {
      for (const EndedEdge& edge : edges_at(db, "edges", showing.map, vertex)) {
        mover.move(edge.id);
        ++moved;
        unconfirmed += edge.confirmed ? 0 : 1;
      }
    }
    count_change(db, showing.map, -moved, -unconfirmed);
  }
  return vertices.size();
}

bool restore_vertex(WriteTransaction& db, MapId map, VertexId vertex) {
  db.prepare("UPDATE images SET deleted_at_us = NULL WHERE map = ? AND vertex = ? AND deleted_at_us IS NOT NULL")
      .bind_all(map, vertex)
      .run();
  if (db.connection().changes() == 0) return false;
  EdgeMover mover(db, "deleted_edges", "edges");
  for (const Showing& showing : maps_showing(db, map, {vertex})) {
    const VertexSet absent = absent_vertices(db, showing.layout);
    std::int64_t moved = 0, unconfirmed = 0;
    for (const EndedEdge& edge : edges_at(db, "deleted_edges", showing.map, showing.vertices.front())) {
      if (absent.contains(edge.other)) continue;
      mover.move(edge.id);
      ++moved;
      unconfirmed += edge.confirmed ? 0 : 1;
    }
    count_change(db, showing.map, moved, unconfirmed);
  }
  return true;
}

void delete_image_bytes(WriteTransaction& db, MapId map, VertexId vertex) {
  db.prepare("DELETE FROM image_bytes WHERE image = (SELECT id FROM images WHERE map = ? AND vertex = ?)")
      .bind_all(map, vertex)
      .run();
  if (db.connection().changes() == 0) return;
  db.prepare("UPDATE maps SET revision = revision + 1 WHERE id = ?").bind(1, map).run();
}

}  // namespace mapweld
