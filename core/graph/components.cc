#include "core/graph/components.h"

#include <algorithm>
#include <stdexcept>

namespace mapweld {

std::uint32_t Components::largest() const {
  if (sizes.empty()) throw std::invalid_argument("a graph without vertices has no largest component");
  return static_cast<std::uint32_t>(std::ranges::max_element(sizes) - sizes.begin());
}

std::vector<VertexId> Components::vertices_of(std::uint32_t component) const {
  std::vector<VertexId> vertices;
  vertices.reserve(sizes.at(component));
  for (std::uint32_t v = 0; v < component_of.size(); ++v) {
    if (component_of[v] == component) vertices.push_back(VertexId{v});
  }
  return vertices;
}

Components connected_components(const AppearanceGraph& graph) {
  constexpr std::uint32_t kUnseen = 0xFFFFFFFF;
  Components result;
  result.component_of.assign(graph.vertices(), kUnseen);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t start = 0; start < graph.vertices(); ++start) {
    if (result.component_of[start] != kUnseen) continue;
    const std::uint32_t component = result.count();
    std::uint32_t size = 0;
    result.component_of[start] = component;
    stack.push_back(start);
    while (!stack.empty()) {
      const std::uint32_t u = stack.back();
      stack.pop_back();
      ++size;
      for (const Neighbour& n : graph.neighbours(VertexId{u})) {
        const std::uint32_t v = to_index(n.vertex);
        if (result.component_of[v] == kUnseen) {
          result.component_of[v] = component;
          stack.push_back(v);
        }
      }
    }
    result.sizes.push_back(size);
  }
  return result;
}

AppearanceGraph induced_subgraph(const AppearanceGraph& graph, std::span<const VertexId> vertices) {
  constexpr std::uint32_t kOutside = 0xFFFFFFFF;
  std::vector<std::uint32_t> inside(graph.vertices(), kOutside);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) inside.at(to_index(vertices[i])) = i;
  AppearanceGraph result(static_cast<std::uint32_t>(vertices.size()));
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    for (const Neighbour& n : graph.neighbours(vertices[i])) {
      const std::uint32_t j = inside[to_index(n.vertex)];
      if (j != kOutside && i < j) result.add_edge(VertexId{i}, VertexId{j}, n.weight);
    }
  }
  return result;
}

}  // namespace mapweld
