#include "core/graph/component_edges.h"

namespace mapweld {

ComponentEdges component_edges(const AppearanceGraph& graph, std::span<const VertexId> component) {
  ComponentEdges result;
  result.number_of.assign(graph.vertices(), ComponentEdges::kOutside);
  for (std::size_t i = 0; i < component.size(); ++i) result.number_of[to_index(component[i])] = static_cast<int>(i);
  for (const VertexId u : component) {
    for (const Neighbour& n : graph.neighbours(u)) {
      if (u >= n.vertex) continue;
      result.edges.push_back({result.number_of[to_index(u)], result.number_of[to_index(n.vertex)], 1.0});
    }
  }
  return result;
}

}  // namespace mapweld
