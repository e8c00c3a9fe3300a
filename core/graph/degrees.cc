#include "core/graph/degrees.h"

#include <algorithm>

namespace mapweld {

std::vector<std::uint32_t> degrees(const AppearanceGraph& graph) {
  std::vector<std::uint32_t> result(graph.vertices());
  for (std::uint32_t v = 0; v < graph.vertices(); ++v) result[v] = graph.degree(VertexId{v});
  return result;
}

std::uint32_t min_degree(const AppearanceGraph& graph) {
  const std::vector<std::uint32_t> all = degrees(graph);
  return all.empty() ? 0 : *std::ranges::min_element(all);
}

}  // namespace mapweld
