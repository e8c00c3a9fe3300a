// Connected components of an appearance graph.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/types.h"

namespace mapweld {

struct Components {
  std::vector<std::uint32_t> component_of;  // by vertex; components are numbered by their lowest vertex, ascending
  std::vector<std::uint32_t> sizes;         // by component
  std::uint32_t count() const { return static_cast<std::uint32_t>(sizes.size()); }
  // The component with the most vertices; of several the one with the lowest vertex. Requires a vertex.
  std::uint32_t largest() const;
  std::vector<VertexId> vertices_of(std::uint32_t component) const;  // ascending
};

// O(V + E). A graph without vertices has no component.
Components connected_components(const AppearanceGraph& graph);

// The graph induced on `vertices`: vertex i of the result is vertices[i]. Ids must be distinct.
AppearanceGraph induced_subgraph(const AppearanceGraph& graph, std::span<const VertexId> vertices);

}  // namespace mapweld
