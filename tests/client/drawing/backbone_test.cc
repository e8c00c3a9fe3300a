// Which edges a dense drawing keeps, against what it promises of them.
#include "client/drawing/backbone.h"

#include <algorithm>
#include <queue>
#include <random>

#include <gtest/gtest.h>

namespace mapweld::drawing {
namespace {

std::vector<WeighedEdge> random_edges(std::size_t vertices, double share, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<WeighedEdge> edges;
  for (std::size_t u = 0; u < vertices; ++u) {
    for (std::size_t v = u + 1; v < vertices; ++v) {
      if (static_cast<double>(random() % 1000) / 1000 < share)
        edges.push_back({u, v, static_cast<double>(random() % 30)});
    }
  }
  return edges;
}

// Whether a path of kept edges of at least this weight leads from u to v.
bool leads(const std::vector<WeighedEdge>& edges, const std::vector<bool>& kept, std::size_t u, std::size_t v,
           double weight, std::size_t vertices) {
  std::vector<bool> seen(vertices, false);
  std::queue<std::size_t> next;
  next.push(u);
  seen[u] = true;
  while (!next.empty()) {
    const std::size_t at = next.front();
    next.pop();
    if (at == v) return true;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (!kept[e] || edges[e].weight < weight) continue;
      for (const auto& [a, b] : {std::pair(edges[e].u, edges[e].v), std::pair(edges[e].v, edges[e].u)}) {
        if (a == at && !seen[b]) {
          seen[b] = true;
          next.push(b);
        }
      }
    }
  }
  return false;
}

TEST(Backbone, KeepsTheWidestPathsAndTheStrongestOfEachVertex) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const std::size_t vertices = 30;
    const std::vector<WeighedEdge> edges = random_edges(vertices, seed < 3 ? 0.6 : 0.05, seed);
    for (const int strongest : {0, 1, 3}) {
      const std::vector<bool> kept = backbone(vertices, edges, strongest);
      ASSERT_EQ(kept.size(), edges.size());
      for (const WeighedEdge& edge : edges) {
        EXPECT_TRUE(leads(edges, kept, edge.u, edge.v, edge.weight, vertices));
      }
      for (std::size_t v = 0; v < vertices; ++v) {
        std::vector<std::size_t> own;
        for (std::size_t e = 0; e < edges.size(); ++e) {
          if (edges[e].u == v || edges[e].v == v) own.push_back(e);
        }
        std::ranges::stable_sort(own, [&](auto a, auto b) { return edges[a].weight > edges[b].weight; });
        for (std::size_t k = 0; k < std::min<std::size_t>(own.size(), static_cast<std::size_t>(strongest)); ++k) {
          EXPECT_TRUE(kept[own[k]]);
        }
      }
      EXPECT_LE(std::ranges::count(kept, true),
                static_cast<std::ptrdiff_t>(vertices * (1 + static_cast<std::size_t>(strongest))));
    }
  }
}

TEST(Backbone, TakesNothingAndLoops) {
  EXPECT_TRUE(backbone(0, {}, 2).empty());
  EXPECT_EQ(backbone(2, std::vector<WeighedEdge>{{1, 1, 9}, {0, 1, 3}}, 1), (std::vector<bool>{false, true}));
}

}  // namespace
}  // namespace mapweld::drawing
