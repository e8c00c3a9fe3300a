#include "core/merge/merge_metrics.h"

#include <utility>

#include "core/graph/matching.h"

namespace mapweld {

MergeMetrics merge_metrics(const AppearanceGraph& graph, const std::vector<MergeMember>& members,
                           std::span<const MergeEdge> inter_edges) {
  MergeMetrics metrics;
  const LargestComponentConnectivity largest = largest_component_connectivity(graph);
  metrics.components = largest.components;
  metrics.largest_vertices = static_cast<std::uint32_t>(largest.vertices.size());
  metrics.largest_algebraic_connectivity = largest.connectivity.value;
  metrics.algebraic_connectivity = largest.components == 1 ? largest.connectivity.value : 0.0;

  std::vector<std::pair<VertexId, VertexId>> ends;
  ends.reserve(inter_edges.size());
  std::vector<bool> is_joined(graph.vertices(), false);
  for (const MergeEdge& e : inter_edges) {
    ends.emplace_back(e.u, e.v);
    is_joined[to_index(e.u)] = is_joined[to_index(e.v)] = true;
  }
  metrics.independent_joins = maximum_matching(ends);
  for (const MergeMember& member : members) {
    std::uint32_t joined = 0;
    for (const VertexId v : member.vertices) joined += is_joined[to_index(v)] ? 1 : 0;
    metrics.joined.push_back(joined);
  }
  return metrics;
}

}  // namespace mapweld
