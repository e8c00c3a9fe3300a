#include "core/merge/merge_metrics.h"

#include <algorithm>

#include "core/graph/matching.h"

namespace mapweld {
namespace {

using Ends = std::vector<std::pair<VertexId, VertexId>>;

Ends ends_of(std::span<const MergeEdge> edges) {
  Ends ends;
  ends.reserve(edges.size());
  for (const MergeEdge& e : edges) ends.emplace_back(e.u, e.v);
  return ends;
}

MergeMetrics metrics_of(const AppearanceGraph& graph, const LargestComponentConnectivity& largest,
                        const std::vector<MergeMember>& members, const Ends& ends) {
  MergeMetrics metrics;
  metrics.components = largest.components;
  metrics.largest_vertices = static_cast<std::uint32_t>(largest.vertices.size());
  metrics.largest_algebraic_connectivity = largest.connectivity.value;
  metrics.algebraic_connectivity = largest.components == 1 ? largest.connectivity.value : 0.0;

  std::vector<bool> is_joined(graph.vertices(), false);
  for (const auto& [u, v] : ends) is_joined[to_index(u)] = is_joined[to_index(v)] = true;
  metrics.independent_joins = maximum_matching(ends);
  for (const MergeMember& member : members) {
    std::uint32_t joined = 0;
    for (const VertexId v : member.vertices) joined += is_joined[to_index(v)] ? 1 : 0;
    metrics.joined.push_back(joined);
  }
  return metrics;
}

}  // namespace

MergeMetrics merge_metrics(const AppearanceGraph& graph, const std::vector<MergeMember>& members,
                           std::span<const MergeEdge> inter_edges) {
  return metrics_of(graph, largest_component_connectivity(graph), members, ends_of(inter_edges));
}

MergeMetrics MergeMetricsFollower::measure(const AppearanceGraph& graph, const std::vector<MergeMember>& members,
                                           std::span<const MergeEdge> inter_edges) {
  Ends ends = ends_of(inter_edges);
  const std::uint64_t inner_edges = graph.edges() - ends.size();
  const bool has_only_grown = eigenvalues_computed_ > 0 && vertices_ == graph.vertices() &&
                              inner_edges_ == inner_edges && seen_.size() <= ends.size() &&
                              std::equal(seen_.begin(), seen_.end(), ends.begin());
  if (!has_only_grown || can_have_changed(connectivity_.last(), std::span(ends).subspan(computed_at_))) {
    connectivity_.refresh(graph);
    computed_at_ = ends.size();
    ++eigenvalues_computed_;
  }
  vertices_ = graph.vertices();
  inner_edges_ = inner_edges;
  seen_ = std::move(ends);
  return metrics_of(graph, connectivity_.last(), members, seen_);
}

}  // namespace mapweld
