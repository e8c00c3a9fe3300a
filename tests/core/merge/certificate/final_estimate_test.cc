#include "core/merge/certificate/final_estimate.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "tests/core/graph/laplacian_oracle.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

VertexId vertex(std::uint32_t v) { return VertexId{v}; }

FinalEstimate estimate(const AppearanceGraph& graph, const std::vector<OpenCandidate>& open, int samples = 6,
                       bool is_brought_up = false) {
  FinalEstimateOptions options;
  options.is_brought_up = is_brought_up;
  options.samples = samples;
  return estimate_final(graph, largest_component_connectivity(graph), open, options);
}

// lambda_2 of `graph` on the vertices of the largest component of `now`.
double dense_on_largest(const AppearanceGraph& now, const AppearanceGraph& graph) {
  const Components components = connected_components(now);
  const AppearanceGraph largest = induced_subgraph(graph, components.vertices_of(components.largest()));
  return test::dense_connectivity(static_cast<int>(largest.vertices()), test::unit_edges(largest));
}

TEST(FinalEstimate, OfWhatIsCertainIsTheTruth) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    const AppearanceGraph graph = test::random_map(10 + seed, 2, 0.05, seed);
    std::mt19937 random(seed);
    AppearanceGraph end = graph;
    std::vector<OpenCandidate> open;
    for (int k = 0; k < 12; ++k) {
      const std::uint32_t u = random() % graph.vertices(), v = random() % graph.vertices();
      if (u == v) continue;
      const bool comes = k % 2 == 0 || graph.has_edge(vertex(u), vertex(v));
      open.push_back({vertex(u), vertex(v), comes ? 1.0 : 0.0});
      if (comes) end.add_edge(vertex(u), vertex(v), 1);
    }
    const double truth = dense_on_largest(graph, graph) / dense_on_largest(graph, end);
    EXPECT_NEAR(estimate(graph, open).fraction, std::min(1.0, truth), 0.02) << "seed " << seed;
    EXPECT_NEAR(estimate(graph, open, 6, true).fraction, std::pow(std::min(1.0, truth), 0.625), 0.02);
  }
  const AppearanceGraph path = test::path(12);
  EXPECT_EQ(estimate(path, {}).fraction, 1);
  EXPECT_EQ(estimate(path, {{vertex(0), vertex(11), 0.0}}).fraction, 1);
  EXPECT_EQ(estimate(AppearanceGraph(), {}).fraction, 1);
}

TEST(FinalEstimate, TellsTheShareOfVerticesThatTheLargestComponentHas) {
  AppearanceGraph graph(12);  // a path of 8, one of 4
  for (std::uint32_t v = 1; v < 12; ++v) {
    if (v != 8) graph.add_edge(vertex(v - 1), vertex(v), 1);
  }
  EXPECT_EQ(estimate(graph, {{vertex(3), vertex(9), 1.0}}).vertices_share, 8.0 / 12);
  EXPECT_EQ(estimate(graph, {{vertex(3), vertex(9), 0.0}}).vertices_share, 1);
  const double half = estimate(graph, {{vertex(3), vertex(9), 0.5}}, 2000).vertices_share;
  EXPECT_NEAR(half, (1 + 8.0 / 12) / 2, 0.02);
}

// Against draws by another generator, in dense arithmetic.
TEST(FinalEstimate, IsTheMeanOverWhatMayCome) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const std::uint32_t n = 30;
    const AppearanceGraph graph = test::random_map(n, 2, 0.03, seed);
    std::mt19937 random(seed);
    std::vector<OpenCandidate> open;
    for (int k = 0; k < 40; ++k) {
      const std::uint32_t u = random() % n, v = random() % n;
      if (u == v || graph.has_edge(vertex(u), vertex(v))) continue;
      open.push_back({vertex(u), vertex(v), 0.01 * static_cast<double>(random() % 40)});
    }
    double sum = 0;
    constexpr int kDraws = 400;
    for (int d = 0; d < kDraws; ++d) {
      AppearanceGraph end = graph;
      for (const OpenCandidate& c : open) {
        if (static_cast<double>(random() % 100000) / 100000 < c.chance) end.add_edge(c.u, c.v, 1);
      }
      sum += std::min(1.0, dense_on_largest(graph, graph) / dense_on_largest(graph, end));
    }
    EXPECT_NEAR(estimate(graph, open, 400).fraction, sum / kDraws, 0.04) << "seed " << seed;
  }
}

TEST(FinalEstimate, CandidatesOfOnePlaceComeTogether) {
  // A cycle that two edges across would make denser: with one place both come or neither.
  AppearanceGraph graph = test::path(20);
  std::vector<OpenCandidate> apart{{vertex(0), vertex(10), 0.5}, {vertex(9), vertex(19), 0.5}}, together = apart;
  for (OpenCandidate& c : together) c.place = {vertex(0), vertex(1)};
  AppearanceGraph both = graph, first = graph, second = graph;
  for (const OpenCandidate& c : apart) both.add_edge(c.u, c.v, 1);
  first.add_edge(apart[0].u, apart[0].v, 1);
  second.add_edge(apart[1].u, apart[1].v, 1);
  const double now = dense_on_largest(graph, graph);
  const double with_both = now / dense_on_largest(graph, both), with_first = now / dense_on_largest(graph, first),
               with_second = now / dense_on_largest(graph, second);
  EXPECT_NEAR(estimate(graph, together, 2000).fraction, (1 + with_both) / 2, 0.03);
  EXPECT_NEAR(estimate(graph, apart, 2000).fraction, (1 + with_both + with_first + with_second) / 4, 0.03);
}

TEST(FinalEstimate, DoesNotDependOnTheOrderOfCandidates) {
  const AppearanceGraph graph = test::random_map(40, 2, 0.02, 4);
  std::mt19937 random(7);
  std::vector<OpenCandidate> open;
  for (int k = 0; k < 60; ++k) {
    const std::uint32_t u = random() % 40, v = random() % 40;
    if (u != v) open.push_back({vertex(u), vertex(v), 0.2});
  }
  const FinalEstimate a = estimate(graph, open, 6, true);
  std::ranges::shuffle(open, random);
  for (OpenCandidate& c : open) std::swap(c.u, c.v);
  EXPECT_EQ(estimate(graph, open, 6, true).fraction, a.fraction);
}

}  // namespace
}  // namespace mapweld
