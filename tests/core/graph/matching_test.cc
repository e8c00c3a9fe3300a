#include "core/graph/matching.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

using Edges = std::vector<std::pair<VertexId, VertexId>>;

// The oracle: take or leave each edge in turn.
std::uint32_t matching_by_enumeration(const Edges& edges, std::size_t from = 0, std::uint64_t taken = 0) {
  if (from == edges.size()) return 0;
  std::uint32_t best = matching_by_enumeration(edges, from + 1, taken);
  const std::uint64_t ends = (1ull << to_index(edges[from].first)) | (1ull << to_index(edges[from].second));
  if (edges[from].first != edges[from].second && (taken & ends) == 0) {
    best = std::max(best, 1 + matching_by_enumeration(edges, from + 1, taken | ends));
  }
  return best;
}

Edges random_edges(std::uint32_t left, std::uint32_t right, bool bipartite, int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  Edges edges;
  for (int k = 0; k < count; ++k) {
    const std::uint32_t all = left + right;
    const VertexId u{static_cast<std::uint32_t>(random() % (bipartite ? left : all))};
    const VertexId v{static_cast<std::uint32_t>(bipartite ? left + random() % right : random() % all)};
    edges.emplace_back(u, v);
  }
  return edges;
}

TEST(MaximumMatching, OfNothingIsZero) {
  EXPECT_EQ(maximum_matching({}), 0u);
  EXPECT_EQ(maximum_matching(Edges{{VertexId{3}, VertexId{3}}}), 0u);
}

TEST(MaximumMatching, AgreesWithEnumerationBetweenTwoSides) {
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    const Edges edges = random_edges(6, 7, true, 3 + static_cast<int>(seed % 13), seed);
    EXPECT_EQ(maximum_matching(edges), matching_by_enumeration(edges)) << "seed " << seed;
  }
}

TEST(MaximumMatching, AgreesWithEnumerationWithOddCycles) {
  for (std::uint32_t seed = 0; seed < 600; ++seed) {
    const Edges edges = random_edges(5, 6, false, 3 + static_cast<int>(seed % 15), seed);
    EXPECT_EQ(maximum_matching(edges), matching_by_enumeration(edges)) << "seed " << seed;
  }
}

TEST(MaximumMatching, FindsLongAugmentingPaths) {
  Edges edges;  // a path of 2k edges inner ones first: a greedy choice has to be undone along all of it
  const std::uint32_t k = 20000;
  for (std::uint32_t v = 1; v < 2 * k; v += 2) edges.emplace_back(VertexId{v}, VertexId{v + 1});
  for (std::uint32_t v = 0; v < 2 * k; v += 2) edges.emplace_back(VertexId{v}, VertexId{v + 1});
  edges.emplace_back(VertexId{2 * k}, VertexId{2 * k + 1});
  EXPECT_EQ(maximum_matching(edges), k + 1);
}

// Two triangles at the ends of a path of 2k vertices. Whoever begins with the path's first edge has to undo all of it,
// from an odd cycle to an odd cycle.
TEST(MaximumMatching, FindsLongAugmentingPathsBetweenOddCycles) {
  const std::uint32_t k = 100000;
  Edges edges;
  for (std::uint32_t v = 1; v < 2 * k; ++v) edges.emplace_back(VertexId{v - 1}, VertexId{v});
  for (const auto& [end, corner] : {std::pair{0u, 2 * k}, std::pair{2 * k - 1, 2 * k + 3}}) {
    edges.emplace_back(VertexId{end}, VertexId{corner});
    for (std::uint32_t i = 0; i < 3; ++i) edges.emplace_back(VertexId{corner + i}, VertexId{corner + (i + 1) % 3});
  }
  EXPECT_EQ(maximum_matching(edges), k + 3);
}

TEST(MaximumMatching, BetweenTwoSidesIsTheLeastVertexCover) {
  std::mt19937 random(9);
  const Edges edges = random_edges(10, 10, true, 40, 9);
  std::uint32_t cover = 20;
  for (std::uint32_t chosen = 0; chosen < (1u << 20); ++chosen) {
    const auto size = static_cast<std::uint32_t>(__builtin_popcount(chosen));
    if (size >= cover) continue;
    if (std::ranges::all_of(edges, [chosen](const auto& e) {
          return ((chosen >> to_index(e.first)) & 1) != 0 || ((chosen >> to_index(e.second)) & 1) != 0;
        })) {
      cover = size;
    }
  }
  EXPECT_EQ(maximum_matching(edges), cover);
}

}  // namespace
}  // namespace mapweld
