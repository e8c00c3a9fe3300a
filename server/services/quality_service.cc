#include "server/services/quality_service.h"

#include <set>
#include <utility>
#include <vector>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/appearance_graph.h"
#include "core/graph/degrees.h"
#include "core/graph/edge_connectivity.h"
#include "core/graph/matching.h"
#include "schema/maps/absent_vertices.h"
#include "schema/maps/edge_store.h"
#include "schema/merges/merge_store.h"
#include "server/maps/map_opener.h"
#include "server/services/map_lookup.h"

namespace mapweld::server {
namespace {

constexpr std::size_t kMaxKnown = 256;  // answers remembered
constexpr std::size_t kEdgesAtOnce = 10'000;

contract::Quality measure(const AppearanceGraph& graph) {
  contract::Quality quality;
  quality.vertices = graph.vertices();
  quality.edges = static_cast<std::int64_t>(graph.edges());
  const LargestComponentConnectivity largest = largest_component_connectivity(graph);
  quality.components = largest.components;
  quality.largest_component = {.vertices = static_cast<std::int64_t>(largest.vertices.size()),
                               .algebraic_connectivity = largest.connectivity.value};
  quality.min_degree = min_degree(graph);
  if (largest.components == 1) {
    quality.algebraic_connectivity = largest.connectivity.value;
    quality.weighted_algebraic_connectivity =
        algebraic_connectivity(graph, AlgebraicConnectivityOptions{.weighting = Weighting::kInliers}).value;
    quality.edge_connectivity = edge_connectivity(graph);
  }
  return quality;
}

// The confirmed edges between the vertices that are there, numbered without gaps.
AppearanceGraph graph_of(const Reader& db, const MapLayout& layout) {
  const VertexSet absent = absent_vertices(db, layout);
  std::vector<std::uint32_t> place(layout.vertices());
  std::uint32_t there = 0;
  for (std::uint32_t v = 0; v < layout.vertices(); ++v) {
    place[v] = there;
    there += absent.contains(VertexId{v}) ? 0 : 1;
  }
  std::vector<Edge> edges = load_edges(db, layout, {.confirmed = true});
  for (Edge& edge : edges) {
    edge.u = VertexId{place[to_index(edge.u)]};
    edge.v = VertexId{place[to_index(edge.v)]};
  }
  return AppearanceGraph(there, edges);
}

std::vector<std::pair<VertexId, VertexId>> inter_edges_of(const Reader& db, JobId merge) {
  std::vector<std::pair<VertexId, VertexId>> edges;
  std::optional<EdgeId> last;
  while (true) {
    const std::vector<EdgeRow> rows = list_merge_edges(db, merge, kEdgesAtOnce, last);
    for (const EdgeRow& row : rows) {
      if (row.confirmed) edges.emplace_back(row.u, row.v);
    }
    if (rows.size() < kEdgesAtOnce) return edges;
    last = rows.back().id;
  }
}

const LayoutNode* node_of(const MapLayout& layout, MapId member) {
  for (std::size_t i = 1; i < layout.nodes().size(); ++i) {
    if (layout.nodes()[i].map == member) return &layout.nodes()[i];
  }
  return nullptr;
}

bool shows(const LayoutNode& node, VertexId vertex) {
  for (const LayoutSpan& span : node.spans) {
    if (vertex >= span.first && to_index(vertex) - to_index(span.first) < span.count) return true;
  }
  return false;
}

}  // namespace

Joins joins_of(const Reader& db, const MapRow& map, const MapLayout& layout) {
  Joins joins;
  const std::optional<MergeRow> merge = find_merge_of(db, map.id);
  if (!merge) return joins;
  const auto edges = inter_edges_of(db, merge->id);
  std::set<VertexId> joined;
  for (const auto& [u, v] : edges) joined.insert({u, v});
  for (const MemberRow& member : list_members(db, map.id)) {
    contract::Joined item{.map = member.name, .vertices = 0};
    if (const LayoutNode* node = node_of(layout, member.map)) {
      for (const VertexId vertex : joined) item.vertices += shows(*node, vertex) ? 1 : 0;
    }
    joins.members.push_back(std::move(item));
  }
  joins.independent = maximum_matching(edges);
  return joins;
}

contract::Quality QualityService::quality(const std::string& map_name) {
  const ReadTransaction db = store_.read();
  const MapRow map = require_map(db, map_name);
  const MapLayout layout = load_layout(db, map.id);
  const std::uint64_t revision = shown_revision(db, layout);
  {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(map.id);
    if (found != known_.end() && found->second.revision == revision) return found->second.quality;
  }
  contract::Quality quality = measure(graph_of(db, layout));
  quality.edge_counts = {.verified = static_cast<std::int64_t>(count_edges(db, layout)), .confirmed = quality.edges};
  if (map.kind == MapKind::kMerged) {
    Joins joins = joins_of(db, map, layout);
    quality.joined = std::move(joins.members);
    quality.independent_joins = joins.independent;
  }
  const std::lock_guard lock(mutex_);
  if (known_.size() >= kMaxKnown) known_.clear();
  known_[map.id] = {revision, quality};
  return quality;
}

}  // namespace mapweld::server
