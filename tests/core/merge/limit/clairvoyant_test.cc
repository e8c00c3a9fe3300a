// The clairvoyant against a greedy search by dense eigenvalues.
#include "core/merge/limit/clairvoyant.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/core/graph/laplacian_oracle.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

using test::dense_connectivity;
using test::unit_edges;
using Pairs = std::vector<std::pair<VertexId, VertexId>>;

// Two maps side by side and candidates between them.
struct TwoMaps {
  AppearanceGraph graph;
  Pairs edges;
};

TwoMaps two_maps(std::uint32_t first, std::uint32_t second, std::size_t edges, std::uint32_t seed) {
  TwoMaps maps{AppearanceGraph(first + second), {}};
  for (const Edge& e : test::random_map(first, 1, 0.1, seed).edge_list()) maps.graph.add_edge(e.u, e.v, 1);
  for (const Edge& e : test::random_map(second, 1, 0.1, seed + 1000).edge_list()) {
    maps.graph.add_edge(VertexId{to_index(e.u) + first}, VertexId{to_index(e.v) + first}, 1);
  }
  std::mt19937 random(seed);
  std::set<std::pair<std::uint32_t, std::uint32_t>> drawn;
  while (drawn.size() < edges) drawn.emplace(random() % first, first + random() % second);
  for (const auto& [u, v] : drawn) maps.edges.emplace_back(VertexId{u}, VertexId{v});
  return maps;
}

double dense_after(const TwoMaps& maps, const std::vector<ClairvoyantPick>& picks, std::size_t count) {
  AppearanceGraph graph = maps.graph;
  for (std::size_t i = 0; i < count; ++i) {
    graph.add_edge(maps.edges[picks[i].edge].first, maps.edges[picks[i].edge].second, 1);
  }
  return std::max(0.0, dense_connectivity(static_cast<int>(graph.vertices()), unit_edges(graph)));
}

// Picks by trying every edge; the values of lambda_2 after each pick.
std::vector<double> exhaustive_greedy(const TwoMaps& maps) {
  AppearanceGraph graph = maps.graph;
  std::vector<double> values;
  while (values.size() < maps.edges.size()) {
    double best_value = -1;
    std::size_t best = 0;
    for (std::size_t e = 0; e < maps.edges.size(); ++e) {
      AppearanceGraph with = graph;
      if (!with.add_edge(maps.edges[e].first, maps.edges[e].second, 1)) continue;
      const double value = dense_connectivity(static_cast<int>(with.vertices()), unit_edges(with));
      if (value > best_value + 1e-12) best_value = value, best = e;
    }
    graph.add_edge(maps.edges[best].first, maps.edges[best].second, 1);
    values.push_back(best_value);
  }
  return values;
}

TEST(Clairvoyant, TellsTheValueOfEachPick) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const TwoMaps maps = two_maps(40, 30, 60, seed);
    const std::vector<ClairvoyantPick> picks = clairvoyant_order(maps.graph, maps.edges);
    ASSERT_EQ(picks.size(), maps.edges.size()) << "without a goal, all";
    std::set<std::uint32_t> taken;
    for (std::size_t i = 0; i < picks.size(); ++i) {
      EXPECT_TRUE(taken.insert(picks[i].edge).second) << "taken twice";
      const double dense = dense_after(maps, picks, i + 1);
      EXPECT_NEAR(picks[i].connectivity, dense, 1e-7 * dense) << seed << ", " << i;
    }
  }
}

TEST(Clairvoyant, TakesTheWidestGapOfTheFiedlerVector) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const TwoMaps maps = two_maps(24, 18, 50, seed);
    const std::vector<ClairvoyantPick> picks = clairvoyant_order(maps.graph, maps.edges, {.max_picks = 20});
    ASSERT_EQ(picks.size(), 20u);
    AppearanceGraph graph = maps.graph;
    std::vector<bool> is_taken(maps.edges.size(), false);
    for (std::size_t i = 0; i < picks.size(); ++i) {
      if (i > 0) {  // the first joins the two maps
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense(
            test::dense_laplacian(static_cast<int>(graph.vertices()), unit_edges(graph)));
        const auto gap = [&](std::size_t e) {
          const auto& [u, v] = maps.edges[e];
          return std::abs(dense.eigenvectors()(to_index(u), 1) - dense.eigenvectors()(to_index(v), 1));
        };
        for (std::size_t e = 0; e < maps.edges.size(); ++e) {
          if (is_taken[e]) continue;
          EXPECT_LE(gap(e), gap(picks[i].edge) + 1e-5) << seed << ", pick " << i << ", edge " << e;
        }
      }
      is_taken[picks[i].edge] = true;
      graph.add_edge(maps.edges[picks[i].edge].first, maps.edges[picks[i].edge].second, 1);
    }
  }
}

TEST(Clairvoyant, KeepsPaceWithTryingEveryEdge) {
  double ours = 0, theirs = 0;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const TwoMaps maps = two_maps(16 + seed, 12, 40, seed);
    const std::vector<double> exhaustive = exhaustive_greedy(maps);
    for (const double share : {0.5, 0.9, 0.95, 0.99}) {
      const double goal = share * exhaustive.back() * (1 - 1e-9);
      const std::vector<ClairvoyantPick> picks = clairvoyant_order(maps.graph, maps.edges, {.goal = goal});
      EXPECT_GE(picks.back().connectivity, goal);
      EXPECT_TRUE(picks.size() == 1 || picks[picks.size() - 2].connectivity < goal) << "stops at the goal";
      const auto reached = std::ranges::find_if(exhaustive, [&](double value) { return value >= goal; });
      ours += static_cast<double>(picks.size());
      theirs += static_cast<double>(reached - exhaustive.begin()) + 1;
    }
  }
  EXPECT_LE(ours, theirs) << "one at a time, the greatest step is not the best way";
}

TEST(Clairvoyant, JoinsLargePartsFirst) {
  AppearanceGraph graph = test::path(6);  // and 6 - 7, 8 - 9 - 10, 11
  for (int v = 0; v < 6; ++v) graph.add_vertex();
  graph.add_edge(VertexId{6}, VertexId{7}, 1);
  graph.add_edge(VertexId{8}, VertexId{9}, 1);
  graph.add_edge(VertexId{9}, VertexId{10}, 1);
  const auto pair = [](std::uint32_t u, std::uint32_t v) { return std::pair(VertexId{u}, VertexId{v}); };
  const Pairs edges{pair(0, 5), pair(0, 11), pair(6, 8), pair(1, 6), pair(10, 2), pair(3, 9), pair(3, 9), pair(2, 1)};
  const std::vector<ClairvoyantPick> picks = clairvoyant_order(graph, edges);
  std::vector<std::uint32_t> order;
  for (const ClairvoyantPick& pick : picks) order.push_back(pick.edge);
  ASSERT_EQ(order.size(), 6u) << "an edge that stands twice is taken once, one that is there never";
  EXPECT_TRUE(order[0] == 4 || order[0] == 5) << "three more: " << order[0];
  EXPECT_TRUE(order[1] == 2 || order[1] == 3) << "two more: " << order[1];
  EXPECT_EQ(order[2], 1u) << "the last one";
  EXPECT_EQ(picks[1].connectivity, 0);
  EXPECT_GT(picks[2].connectivity, 0);
}

TEST(Clairvoyant, KnowsItsLimits) {
  const Pairs beyond{{VertexId{0}, VertexId{3}}};
  EXPECT_THROW(clairvoyant_order(test::path(3), beyond), std::invalid_argument);
  EXPECT_TRUE(clairvoyant_order(AppearanceGraph(), {}).empty());
  EXPECT_TRUE(clairvoyant_order(test::path(3), {}).empty());
  const Pairs one{{VertexId{0}, VertexId{2}}};
  EXPECT_TRUE(clairvoyant_order(test::path(3), one, {.goal = 0.5}).empty()) << "is there already";
  EXPECT_TRUE(clairvoyant_order(test::path(3), one, {.max_picks = 0}).empty());
}

}  // namespace
}  // namespace mapweld
