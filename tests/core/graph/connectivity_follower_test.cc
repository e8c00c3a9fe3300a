#include "core/graph/connectivity_follower.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "tests/core/graph/laplacian_oracle.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

double dense(const AppearanceGraph& graph) {
  const Components components = connected_components(graph);
  const AppearanceGraph largest = induced_subgraph(graph, components.vertices_of(components.largest()));
  return test::dense_connectivity(static_cast<int>(largest.vertices()), test::unit_edges(largest));
}

TEST(ConnectivityFollower, AgreesWithADenseSolverAsEdgesArrive) {
  std::uint64_t asked = 0, factors = 0;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    AppearanceGraph graph(120);
    for (std::uint32_t v = 1; v < 120; ++v) {
      if (v != 70 && v != 9 && v != 30) graph.add_edge(VertexId{v}, VertexId{v - 1}, 1);
      if (v > 75 || (v > 33 && v < 70)) graph.add_edge(VertexId{v}, VertexId{v - 2}, 1);
    }
    std::mt19937 random(seed);
    ConnectivityFollower follower;
    for (int k = 0; k < 80; ++k) {
      const LargestComponentConnectivity& followed = follower.refresh(graph);
      const LargestComponentConnectivity fresh = largest_component_connectivity(graph);
      const double expected = dense(graph);
      EXPECT_NEAR(followed.connectivity.value, expected, 1e-6 * expected) << "seed " << seed << " step " << k;
      EXPECT_EQ(followed.vertices, fresh.vertices);
      EXPECT_EQ(followed.components, fresh.components);
      EXPECT_EQ(followed.connectivity.fiedler.size(), fresh.connectivity.fiedler.size());
      ++asked;
      for (int more = 0; more < static_cast<int>(1 + seed % 3); ++more) {
        const VertexId u{static_cast<std::uint32_t>(random() % 120)}, v{static_cast<std::uint32_t>(random() % 120)};
        if (u != v) graph.add_edge(u, v, 1);
      }
    }
    factors += follower.factors_made();
  }
  EXPECT_LT(factors, asked * 2 / 3);  // most edges here are long: a hard case for an old factor
}

// Two walks side by side: the vector that is even under their exchange gives way to the odd one, or the other way
// round, when edges are added or taken; the old vector alone would never show the new.
TEST(ConnectivityFollower, FindsAVectorOfAnotherSymmetry) {
  const auto ladder = [](std::uint32_t rungs) {
    const std::uint32_t n = 40;
    AppearanceGraph graph(2 * n);
    for (std::uint32_t v = 1; v < n; ++v) {
      graph.add_edge(VertexId{v}, VertexId{v - 1}, 1);
      graph.add_edge(VertexId{n + v}, VertexId{n + v - 1}, 1);
    }
    for (std::uint32_t k = 0; k < rungs; ++k) graph.add_edge(VertexId{k * n / rungs}, VertexId{n + k * n / rungs}, 1);
    return graph;
  };
  ConnectivityFollower follower;
  for (const std::uint32_t rungs : {1u, 2u, 4u, 8u, 20u, 40u, 20u, 4u, 1u}) {
    const AppearanceGraph graph = ladder(rungs);
    EXPECT_NEAR(follower.refresh(graph).connectivity.value, dense(graph), 1e-6 * dense(graph)) << rungs << " rungs";
  }
}

TEST(ConnectivityFollower, TakesAnyGraph) {
  ConnectivityFollower follower;
  EXPECT_EQ(follower.refresh(AppearanceGraph()).components, 0u);
  EXPECT_EQ(follower.refresh(AppearanceGraph(5)).connectivity.value, 0.0);
  EXPECT_NEAR(follower.refresh(test::complete(40)).connectivity.value, 40, 1e-10);
  EXPECT_NEAR(follower.refresh(test::path(2)).connectivity.value, 2, 1e-10);
  EXPECT_NEAR(follower.refresh(test::star(40)).connectivity.value, 1, 1e-10);
  EXPECT_EQ(follower.refresh(AppearanceGraph()).components, 0u);
}

}  // namespace
}  // namespace mapweld
