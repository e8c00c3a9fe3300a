// What edge_store.h lists. Each statement names its index: SQLite's planner knows nothing of the sizes of maps, and
// would rather walk all edges of a map in order than sort the few of a vertex (tests/schema/query_plan_test.cc).
#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "schema/blobs/evidence_blob.h"
#include "schema/maps/edge_rows.h"
#include "schema/maps/edge_store.h"

namespace mapweld {
namespace {

// The edge as the layout numbers it; its ends keep their order, since numbers grow together.
EdgeRow renumber(EdgeRow edge, const LayoutNode& node) {
  edge.u = *node.number(edge.u);
  edge.v = *node.number(edge.v);
  return edge;
}

// Can this node have edges that pass the filter?
bool passes(const LayoutNode& node, const EdgeFilter& filter) {
  return !filter.inter || *filter.inter == (node.kind == MapKind::kMerged);
}

// The first id from which on no edge of the node shows. A plain map gets its edges with their later ends, in order of
// number, so that what lies beyond the watermark came last.
std::int64_t end_of_shown(const Reader& db, const LayoutNode& node) {
  constexpr std::int64_t kNoEnd = std::numeric_limits<std::int64_t>::max();
  if (node.kind == MapKind::kMerged) return kNoEnd;
  sqlite::Statement row =
      db.prepare("SELECT id FROM edges INDEXED BY edges_by_later_end WHERE map = ? AND v >= ? ORDER BY v, id LIMIT 1");
  return row.bind_all(node.map, node.watermark).step() ? row.integer(0) : kNoEnd;
}

// The shown edges of a node that pass a filter, by id; bind_shown binds ?1 to ?5. ?6 is free.
std::string shown(const EdgeFilter& filter) {
  const bool only_withheld = filter.confirmed == false;
  std::string text = only_withheld ? "INDEXED BY edges_withheld " : "INDEXED BY edges_in_order ";
  text += "WHERE map = ?1 AND id > ?2 AND id < ?3 AND v < ?4 AND inliers >= ?5 ";
  if (filter.confirmed) text += only_withheld ? "AND confirmed = 0 " : "AND confirmed = 1 ";
  return text + "ORDER BY id ";
}

void bind_shown(sqlite::Statement& statement, const Reader& db, const LayoutNode& node, const EdgeFilter& filter,
                std::int64_t after) {
  statement.bind_all(node.map, after, end_of_shown(db, node), node.watermark, filter.min_inliers);
}

std::uint64_t count_of(sqlite::Statement statement) {
  statement.step();
  return static_cast<std::uint64_t>(statement.integer(0));
}

// Adds `factor` to the degree of a vertex for each of a node's edges that `statement` counts, by vertex of the node.
void add_counts(sqlite::Statement statement, const LayoutNode& node, VertexId first, int factor,
                std::vector<std::int64_t>& degrees) {
  while (statement.step()) {
    const std::uint32_t vertex = to_index(*node.number(statement.id<VertexId>(0)));
    degrees.at(vertex - to_index(first)) += factor * statement.integer(1);
  }
}

}  // namespace

EdgePage list_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter, std::size_t limit,
                    EdgeCursor after) {
  EdgePage page;
  const auto& nodes = layout.nodes();
  for (std::uint32_t n = after.node; n < nodes.size(); ++n) {
    const LayoutNode& node = nodes[n];
    const std::int64_t after_edge = n == after.node ? after.edge : 0;
    if (!passes(node, filter)) continue;
    if (page.edges.size() == limit) {
      page.next = EdgeCursor{n, after_edge};
      return page;
    }
    sqlite::Statement row = db.prepare(rows::select_edges(shown(filter) + "LIMIT ?6"));
    bind_shown(row, db, node, filter, after_edge);
    // One more than asked for tells whether there is a next page.
    row.bind(6, limit - page.edges.size() + 1);
    while (row.step()) {
      if (page.edges.size() == limit) {
        page.next = EdgeCursor{n, to_index(page.edges.back().id)};
        return page;
      }
      page.edges.push_back(renumber(rows::edge(row), node));
    }
  }
  return page;
}

std::vector<Edge> load_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter) {
  std::vector<Edge> edges;
  for (const LayoutNode& node : layout.nodes()) {
    if (!passes(node, filter)) continue;
    sqlite::Statement row = db.prepare("SELECT u, v, inliers FROM edges " + shown(filter));
    bind_shown(row, db, node, filter, 0);
    while (row.step()) {
      edges.push_back({*node.number(row.id<VertexId>(0)), *node.number(row.id<VertexId>(1)),
                       static_cast<std::uint32_t>(row.integer(2))});
    }
  }
  return edges;
}

std::vector<VerifiedEdge> load_verified_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter) {
  std::vector<VerifiedEdge> edges;
  for (const LayoutNode& node : layout.nodes()) {
    if (!passes(node, filter)) continue;
    sqlite::Statement row = db.prepare("SELECT u, v, evidence FROM edges " + shown(filter));
    bind_shown(row, db, node, filter, 0);
    while (row.step()) {
      Verification verdict;
      blobs::decode_evidence(row.blob(2), verdict);
      edges.push_back(
          {*node.number(row.id<VertexId>(0)), *node.number(row.id<VertexId>(1)), std::move(verdict.inlier_matches)});
    }
  }
  return edges;
}

std::uint64_t count_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter) {
  std::uint64_t count = 0;
  for (const LayoutNode& node : layout.nodes()) {
    if (!passes(node, filter)) continue;
    if (filter.min_inliers > 0) {
      sqlite::Statement row = db.prepare("SELECT count(*) FROM edges " + shown(filter));
      bind_shown(row, db, node, filter, 0);
      count += count_of(std::move(row));
      continue;
    }
    const auto map = find_map(db, node.map);
    std::uint64_t all = 0, withheld = 0;
    if (map && map->vertices == node.watermark) {
      // Everything shows through: the map's own counters are the answer.
      all = map->edges;
      withheld = map->unconfirmed;
    } else {
      sqlite::Statement row =
          db.prepare("SELECT count(*) FROM edges INDEXED BY edges_by_later_end WHERE map = ? AND v < ?");
      row.bind_all(node.map, node.watermark);
      all = count_of(std::move(row));
      sqlite::Statement unconfirmed = db.prepare(
          "SELECT count(*) FROM edges INDEXED BY edges_withheld_by_later_end WHERE map = ? AND v < ? AND confirmed = "
          "0");
      unconfirmed.bind_all(node.map, node.watermark);
      withheld = count_of(std::move(unconfirmed));
    }
    if (filter.confirmed != false) count += all - withheld;
    if (filter.confirmed != true) count += withheld;
  }
  return count;
}

std::vector<std::int64_t> count_confirmed_edges_at(const Reader& db, const MapLayout& layout, VertexId first,
                                                   std::uint32_t count) {
  std::vector<std::int64_t> degrees(count);
  const std::uint64_t begin = to_index(first), end = begin + count;
  for (const LayoutNode& node : layout.nodes()) {
    for (const LayoutSpan& span : node.spans) {
      const std::uint64_t span_begin = to_index(span.first);
      const std::uint64_t from = std::max(begin, span_begin), to = std::min(end, span_begin + span.count);
      if (from >= to) continue;
      const std::uint64_t node_from = to_index(span.node_first) + (from - span_begin),
                          node_to = node_from + (to - from);
      const auto add = [&](std::string_view sql, int factor) {
        sqlite::Statement row = db.prepare(sql);
        row.bind_all(node.map, node_from, node_to, node.watermark);
        add_counts(std::move(row), node, first, factor, degrees);
      };
      // The index of the constraint UNIQUE (map, u, v) has no name that a statement may say.
      add("SELECT u, count(*) FROM edges WHERE map = ?1 AND u >= ?2 AND u < ?3 AND v < ?4 GROUP BY u", 1);
      add("SELECT v, count(*) FROM edges INDEXED BY edges_by_later_end WHERE map = ?1 AND v >= ?2 AND v < ?3 "
          "AND v < ?4 GROUP BY v",
          1);
      add("SELECT u, count(*) FROM edges INDEXED BY edges_withheld_by_earlier_end WHERE map = ?1 AND u >= ?2 "
          "AND u < ?3 AND v < ?4 AND confirmed = 0 GROUP BY u",
          -1);
      add("SELECT v, count(*) FROM edges INDEXED BY edges_withheld_by_later_end WHERE map = ?1 AND v >= ?2 "
          "AND v < ?3 AND v < ?4 AND confirmed = 0 GROUP BY v",
          -1);
    }
  }
  return degrees;
}

std::vector<EdgeRow> list_own_edges_at(const Reader& db, MapId map, VertexId vertex) {
  std::vector<EdgeRow> edges;
  // Two statements: of one with both ends, and an order by id, SQLite makes a walk over all edges of the map.
  for (const std::string_view end :
       {"WHERE map = ? AND u = ?", "INDEXED BY edges_by_later_end WHERE map = ? AND v = ?"}) {
    sqlite::Statement row = db.prepare(rows::select_edges(end));
    row.bind_all(map, vertex);
    while (row.step()) edges.push_back(rows::edge(row));
  }
  std::ranges::sort(edges, {}, &EdgeRow::id);
  return edges;
}

std::vector<EdgeRow> list_edges_at(const Reader& db, const MapLayout& layout, VertexId vertex) {
  std::vector<EdgeRow> edges;
  for (const LayoutNode& node : layout.nodes()) {
    const auto own = node.node_vertex(vertex);
    if (!own) continue;
    for (const EdgeRow& edge : list_own_edges_at(db, node.map, *own)) {
      if (to_index(edge.v) < node.watermark) edges.push_back(renumber(edge, node));
    }
  }
  return edges;
}

std::optional<EdgeRow> find_own_edge(const Reader& db, MapId map, VertexId u, VertexId v) {
  sqlite::Statement row = db.prepare(rows::select_edges("WHERE map = ? AND u = ? AND v = ?"));
  if (!row.bind_all(map, std::min(u, v), std::max(u, v)).step()) return std::nullopt;
  return rows::edge(row);
}

std::optional<EdgeRow> find_edge(const Reader& db, const MapLayout& layout, VertexId u, VertexId v) {
  for (const LayoutNode& node : layout.nodes()) {
    const auto own_u = node.node_vertex(u), own_v = node.node_vertex(v);
    if (!own_u || !own_v) continue;
    if (auto edge = find_own_edge(db, node.map, *own_u, *own_v)) return renumber(std::move(*edge), node);
  }
  return std::nullopt;
}

}  // namespace mapweld
