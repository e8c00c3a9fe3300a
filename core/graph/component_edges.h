// The edges of one component, numbered for a Laplacian of its own.
#pragma once

#include <span>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/graph/grounded_laplacian.h"

namespace mapweld {

struct ComponentEdges {
  static constexpr int kOutside = -1;
  std::vector<int> number_of;        // by vertex of the graph: its place in the component, or kOutside
  std::vector<LaplacianEdge> edges;  // of weight 1, by these numbers
};

// `component`: all vertices of one component of `graph`, ascending.
ComponentEdges component_edges(const AppearanceGraph& graph, std::span<const VertexId> component);

}  // namespace mapweld
