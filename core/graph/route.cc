#include "core/graph/route.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <stdexcept>
#include <utility>

namespace mapweld {
namespace {

constexpr std::uint32_t kUnlimited = std::numeric_limits<std::uint32_t>::max();

// The greatest w such that edges of weight >= w connect the two; nullopt when no edges do. Dijkstra's algorithm with
// (min, max) for (+, min).
std::optional<std::uint32_t> widest(const AppearanceGraph& graph, VertexId from, VertexId to) {
  std::vector<std::optional<std::uint32_t>> width(graph.vertices());
  std::priority_queue<std::pair<std::uint32_t, VertexId>> queue;
  width[to_index(from)] = kUnlimited;
  queue.emplace(kUnlimited, from);
  while (!queue.empty()) {
    const auto [reached, vertex] = queue.top();
    queue.pop();
    if (vertex == to) return reached;
    if (reached < width[to_index(vertex)]) continue;
    for (const Neighbour& next : graph.neighbours(vertex)) {
      const std::uint32_t through = std::min(reached, next.weight);
      auto& known = width[to_index(next.vertex)];
      if (known && *known >= through) continue;
      known = through;
      queue.emplace(through, next.vertex);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Route> widest_route(const AppearanceGraph& graph, VertexId from, VertexId to) {
  if (to_index(from) >= graph.vertices() || to_index(to) >= graph.vertices()) {
    throw std::invalid_argument("a route's end is not in the graph");
  }
  const std::optional<std::uint32_t> width = widest(graph, from, to);
  if (!width) return std::nullopt;
  if (from == to) return Route{{from}, 0};

  // Breadth first over the edges that are wide enough; levels count from `from`.
  std::vector<std::uint32_t> level(graph.vertices(), kUnlimited);
  level[to_index(from)] = 0;
  std::vector<VertexId> queue = {from};
  for (std::size_t i = 0; i < queue.size() && level[to_index(to)] == kUnlimited; ++i) {
    for (const Neighbour& next : graph.neighbours(queue[i])) {
      if (next.weight < *width || level[to_index(next.vertex)] != kUnlimited) continue;
      level[to_index(next.vertex)] = level[to_index(queue[i])] + 1;
      queue.push_back(next.vertex);
    }
  }
  Route route{{to}, *width};
  for (VertexId at = to; at != from;) {
    std::optional<VertexId> before;
    for (const Neighbour& next : graph.neighbours(at)) {
      if (next.weight < *width || level[to_index(next.vertex)] + 1 != level[to_index(at)]) continue;
      if (!before || next.vertex < *before) before = next.vertex;
    }
    at = before.value();
    route.vertices.push_back(at);
  }
  std::ranges::reverse(route.vertices);
  return route;
}

}  // namespace mapweld
