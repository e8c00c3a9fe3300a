#include "core/graph/sparsify.h"

#include <algorithm>
#include <random>

#include "core/graph/disjoint_sets.h"

namespace mapweld {

std::vector<LaplacianEdge> sparsify(int vertices, std::span<const LaplacianEdge> edges, double oversampling) {
  DisjointSets sets(static_cast<std::uint32_t>(vertices));
  std::vector<double> degree(vertices, 0);
  for (const LaplacianEdge& e : edges) {
    degree[e.u] += e.weight;
    degree[e.v] += e.weight;
  }
  std::mt19937_64 random(2011);
  std::vector<LaplacianEdge> kept;
  kept.reserve(edges.size());
  for (const LaplacianEdge& e : edges) {
    const double drawn = static_cast<double>(random() >> 11) * 0x1p-53;
    if (sets.join(static_cast<std::uint32_t>(e.u), static_cast<std::uint32_t>(e.v))) {
      kept.push_back(e);
      continue;
    }
    const double share = std::min(1.0, oversampling * e.weight * (1 / degree[e.u] + 1 / degree[e.v]));
    if (drawn < share) kept.push_back({e.u, e.v, e.weight / share});
  }
  return kept;
}

}  // namespace mapweld
