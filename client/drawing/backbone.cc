#include "client/drawing/backbone.h"

#include <algorithm>
#include <numeric>

#include <boost/pending/disjoint_sets.hpp>

namespace mapweld::drawing {

std::vector<bool> backbone(std::size_t vertices, std::span<const WeighedEdge> edges, int strongest) {
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return edges[a].weight > edges[b].weight; });

  boost::disjoint_sets_with_storage<> sets(vertices);
  std::vector<int> taken(vertices, 0);
  std::vector<bool> kept(edges.size(), false);
  for (const std::size_t e : order) {
    const auto [u, v, weight] = edges[e];
    if (u == v) continue;
    const bool joins = sets.find_set(u) != sets.find_set(v);
    sets.union_set(u, v);
    kept[e] = joins || taken[u] < strongest || taken[v] < strongest;
    ++taken[u];
    ++taken[v];
  }
  return kept;
}

}  // namespace mapweld::drawing
