#include "core/merge/merge_metrics.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/graph/laplacian_oracle.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

MergeEdge edge(std::uint32_t u, std::uint32_t v) {
  MergeEdge e;
  e.u = VertexId{u};
  e.v = VertexId{v};
  return e;
}

TEST(MergeMetrics, CountsWhatIsJoined) {
  const std::vector<MergeMember> members = number_members({4, 3});
  AppearanceGraph graph(7);
  for (const auto& [u, v] : {std::pair{0u, 1u}, {1u, 2u}, {4u, 5u}}) graph.add_edge(VertexId{u}, VertexId{v}, 20);
  const MergeMetrics before = merge_metrics(graph, members, {});
  EXPECT_EQ(before.components, 4u);
  EXPECT_EQ(before.algebraic_connectivity, 0.0);
  EXPECT_EQ(before.largest_vertices, 3u);
  EXPECT_NEAR(before.largest_algebraic_connectivity, 1.0, 1e-12);  // a path of three
  EXPECT_EQ(before.joined, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_EQ(before.independent_joins, 0u);

  // Two edges share vertex 2: one image's removal would cut both.
  const std::vector<MergeEdge> inter{edge(2, 4), edge(2, 5), edge(3, 6)};
  for (const MergeEdge& e : inter) graph.add_edge(e.u, e.v, 15);
  const MergeMetrics after = merge_metrics(graph, members, inter);
  EXPECT_EQ(after.components, 2u);
  EXPECT_EQ(after.joined, (std::vector<std::uint32_t>{2, 3}));
  EXPECT_EQ(after.independent_joins, 2u);
  EXPECT_EQ(after.largest_vertices, 5u);
  EXPECT_GT(after.largest_algebraic_connectivity, 0.0);
}

TEST(MergeMetrics, OnlyGrowWhereTheyShould) {
  const auto merger = make_merger(make_toy_merge(test::toy_world(19)));
  MergeMetrics before = merge_metrics(merger->graph(), merger->input().members, merger->state().edges);
  run(*merger, {}, [&before](const Merger& m) {
    const MergeMetrics now = merge_metrics(m.graph(), m.input().members, m.state().edges);
    EXPECT_LE(now.components, before.components);
    EXPECT_GE(now.algebraic_connectivity, before.algebraic_connectivity * (1 - 1e-12));
    EXPECT_GE(now.independent_joins, before.independent_joins);
    for (std::size_t k = 0; k < now.joined.size(); ++k) EXPECT_GE(now.joined[k], before.joined[k]);
    before = now;
  });
  EXPECT_GT(before.independent_joins, 10u);
}

double relative_difference(double a, double b) { return a == b ? 0 : std::abs(a - b) / std::max(a, b); }

double dense_connectivity(const AppearanceGraph& graph) {
  const Components components = connected_components(graph);
  const AppearanceGraph largest = induced_subgraph(graph, components.vertices_of(components.largest()));
  return test::dense_connectivity(static_cast<int>(largest.vertices()), test::unit_edges(largest));
}

// Two walks whose inter edges come at random: mostly between the same few places after a while.
TEST(MergeMetricsFollower, AgreesWithADenseSolverAtEveryEdge) {
  std::uint64_t asked = 0, computed = 0;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const std::vector<MergeMember> members = number_members({50, 40});
    AppearanceGraph graph(90);
    for (std::uint32_t v = 1; v < 90; ++v) {
      if (v != 50 && v != 7) graph.add_edge(VertexId{v}, VertexId{v - 1}, 20);
      if (v > 54 || (v < 50 && v > 14)) graph.add_edge(VertexId{v}, VertexId{v - 3}, 20);
    }
    std::mt19937 random(seed);
    std::vector<MergeEdge> inter;
    MergeMetricsFollower follower;
    for (int k = 0; k < 150; ++k) {
      const std::uint32_t u = random() % 50, v = 50 + random() % 40;
      const std::uint32_t narrow = random() % 3;
      const MergeEdge e = narrow > 0 ? edge(20 + u % 12, 70 + v % 12) : edge(u, v);
      if (!graph.add_edge(e.u, e.v, 15)) continue;
      inter.push_back(e);
      const MergeMetrics followed = follower.measure(graph, members, inter);
      MergeMetrics fresh = merge_metrics(graph, members, inter);
      ++asked;
      EXPECT_LT(relative_difference(followed.largest_algebraic_connectivity, dense_connectivity(graph)), 1e-6);
      EXPECT_LT(relative_difference(followed.algebraic_connectivity, fresh.algebraic_connectivity), 1e-6);
      // What certify() is told of the largest component holds for the graph as it is now.
      const LargestComponentConnectivity now = largest_component_connectivity(graph);
      EXPECT_EQ(follower.largest().vertices, now.vertices);
      EXPECT_LE(follower.largest().connectivity.value, now.connectivity.value * (1 + 1e-9));
      fresh.algebraic_connectivity = followed.algebraic_connectivity;
      fresh.largest_algebraic_connectivity = followed.largest_algebraic_connectivity;
      EXPECT_EQ(followed, fresh);
    }
    computed += follower.eigenvalues_computed();
  }
  EXPECT_GT(asked, 700u);
  EXPECT_LT(computed, asked);
}

TEST(MergeMetricsFollower, StartsAnewWhenAnEdgeGoesOrAVertexComes) {
  const std::vector<MergeMember> members = number_members({4, 3});
  const auto graph_with = [](std::uint32_t vertices, const std::vector<MergeEdge>& inter) {
    AppearanceGraph graph(vertices);
    for (const auto& [u, v] : {std::pair{0u, 1u}, {1u, 2u}, {2u, 3u}, {4u, 5u}, {5u, 6u}}) {
      graph.add_edge(VertexId{u}, VertexId{v}, 20);
    }
    for (const MergeEdge& e : inter) graph.add_edge(e.u, e.v, 15);
    return graph;
  };
  MergeMetricsFollower follower;
  const std::vector<std::vector<MergeEdge>> histories{
      {}, {edge(0, 4)}, {edge(0, 4), edge(3, 6)}, {edge(0, 4)}, {edge(1, 5)}, {edge(3, 6), edge(0, 4)}, {}};
  for (const std::uint32_t vertices : {7u, 8u}) {
    for (const auto& inter : histories) {
      const AppearanceGraph graph = graph_with(vertices, inter);
      EXPECT_EQ(follower.measure(graph, members, inter), merge_metrics(graph, members, inter));
    }
  }
}

}  // namespace
}  // namespace mapweld
