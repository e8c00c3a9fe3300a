#include "client/drawing/backbone.h"

#include <algorithm>
#include <numeric>

namespace mapweld::drawing {

std::vector<bool> backbone(std::size_t vertices, std::span<const WeighedEdge> edges, int strongest) {
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return edges[a].weight > edges[b].weight; });

  std::vector<std::size_t> parent(vertices);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<int> taken(vertices, 0);
  std::vector<bool> kept(edges.size(), false);
  for (const std::size_t e : order) {
    const auto [u, v, weight] = edges[e];
    if (u == v) continue;
    const std::size_t a = root(u);
    const std::size_t b = root(v);
    const bool joins = a != b;
    if (joins) parent[a] = b;
    kept[e] = joins || taken[u] < strongest || taken[v] < strongest;
    ++taken[u];
    ++taken[v];
  }
  return kept;
}

}  // namespace mapweld::drawing
