// The bound against every choice there is.
#include "core/merge/limit/choice_bound.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/limit/clairvoyant.h"
#include "tests/core/graph/laplacian_oracle.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

using test::dense_connectivity;
using test::unit_edges;
using Pairs = std::vector<std::pair<VertexId, VertexId>>;

struct Case {
  AppearanceGraph graph;
  Pairs edges;
};

// Paths side by side, and edges between any two vertices; whole when all are taken.
Case random_case(std::uint32_t vertices, std::size_t edges, std::uint32_t seed) {
  std::mt19937 random(seed);
  while (true) {
    Case c{AppearanceGraph(vertices), {}};
    for (std::uint32_t v = 0; v + 1 < vertices; ++v) {
      if (random() % 4 != 0) c.graph.add_edge(VertexId{v}, VertexId{v + 1}, 1);
    }
    AppearanceGraph whole = c.graph;
    while (c.edges.size() < edges) {
      const VertexId u{static_cast<std::uint32_t>(random() % vertices)};
      const VertexId v{static_cast<std::uint32_t>(random() % vertices)};
      if (u != v && whole.add_edge(u, v, 1)) c.edges.emplace_back(u, v);
    }
    if (dense_connectivity(static_cast<int>(vertices), unit_edges(whole)) > 1e-6) return c;
  }
}

double dense_with(const Case& c, std::uint32_t mask) {
  AppearanceGraph graph = c.graph;
  for (std::size_t e = 0; e < c.edges.size(); ++e) {
    if (mask >> e & 1u) graph.add_edge(c.edges[e].first, c.edges[e].second, 1);
  }
  return std::max(0.0, dense_connectivity(static_cast<int>(graph.vertices()), unit_edges(graph)));
}

TEST(ChoiceBound, IsAboveEveryChoice) {
  double excess = 0;
  int choices = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Case c = random_case(8 + seed % 5, 10, seed);
    std::vector<double> best(c.edges.size() + 1, 0);
    for (std::uint32_t mask = 0; mask < 1u << c.edges.size(); ++mask) {
      double& value = best[static_cast<std::size_t>(std::popcount(mask))];
      value = std::max(value, dense_with(c, mask));
    }
    for (std::uint32_t count = 0; count <= c.edges.size(); ++count) {
      const double bound = choice_bound(c.graph, c.edges, count);
      EXPECT_GE(bound, best[count] * (1 - 1e-9) - 1e-12) << seed << ", " << count;
      EXPECT_LE(bound, best.back() * (1 + 1e-9)) << "more than with all edges";
      EXPECT_EQ(bound > 0, best[count] > 1e-9) << "joined or not";
      if (best[count] < best.back() / 2) continue;
      excess += bound / best[count] - 1;
      ++choices;
    }
    EXPECT_NEAR(choice_bound(c.graph, c.edges, 10), best.back(), 1e-9);
    EXPECT_NEAR(choice_bound(c.graph, c.edges, 11), best.back(), 1e-9);
  }
  EXPECT_LT(excess / choices, 0.15) << "a bound that says little of the upper half";
}

TEST(ChoiceBound, IsAboveTheClairvoyant) {
  for (std::uint32_t seed = 30; seed < 34; ++seed) {
    const Case c = random_case(60, 50, seed);
    const std::vector<ClairvoyantPick> picks = clairvoyant_order(c.graph, c.edges);
    ASSERT_EQ(picks.size(), c.edges.size());
    std::vector<std::uint32_t> good;
    for (const ClairvoyantPick& pick : picks) good.push_back(pick.edge);
    for (std::uint32_t count = 1; count <= c.edges.size(); count += 7) {
      const double reached = picks[count - 1].connectivity * (1 - 1e-7);
      const double bound = choice_bound(c.graph, c.edges, count);
      EXPECT_GE(bound, reached) << seed << ", " << count;
      const double from_good = choice_bound(c.graph, c.edges, count, {.good = good});
      EXPECT_GE(from_good, reached) << seed << ", " << count;
    }
  }
}

// A ring and its diameters: by symmetry equal weights are the best, and lambda_2, twice over, is known.
TEST(ChoiceBound, FindsTheBestWeightsWhereEigenvaluesAreEqual) {
  const AppearanceGraph ring = test::cycle(20);
  Pairs diameters;
  for (std::uint32_t v = 0; v < 10; ++v) diameters.emplace_back(VertexId{v}, VertexId{v + 10});
  const double best = 2 - 2 * std::cos(2 * std::acos(-1.0) / 20) + 2 * 0.1;
  const double bound = choice_bound(ring, diameters, 1);
  EXPECT_GE(bound, best * (1 - 1e-9));
  EXPECT_LE(bound, best * 1.05);
  EXPECT_GT(choice_bound(ring, diameters, 1, {.iterations = 1}), best * 1.2) << "one vector alone does not tell";
}

TEST(ChoiceBound, RefusesWhatHasNoBound) {
  const Pairs twice{{VertexId{0}, VertexId{2}}, {VertexId{2}, VertexId{0}}};
  EXPECT_THROW(choice_bound(test::path(3), twice, 1), std::invalid_argument);
  EXPECT_THROW(choice_bound(AppearanceGraph(3), Pairs{{VertexId{0}, VertexId{1}}}, 1), std::invalid_argument);
  EXPECT_EQ(choice_bound(AppearanceGraph(2), Pairs{{VertexId{0}, VertexId{1}}}, 0), 0);
  EXPECT_NEAR(choice_bound(AppearanceGraph(2), Pairs{{VertexId{0}, VertexId{1}}}, 1), 2, 1e-12);
}

}  // namespace
}  // namespace mapweld
