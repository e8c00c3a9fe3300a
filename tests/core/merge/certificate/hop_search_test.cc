#include "core/merge/certificate/hop_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

VertexId vertex(std::uint32_t v) { return VertexId{v}; }

// All distances by Floyd and Warshall.
std::vector<std::vector<double>> distances(const AppearanceGraph& graph) {
  const std::size_t n = graph.vertices();
  std::vector<std::vector<double>> d(n, std::vector<double>(n, std::numeric_limits<double>::infinity()));
  for (std::size_t v = 0; v < n; ++v) d[v][v] = 0;
  for (const Edge& e : graph.edge_list()) d[to_index(e.u)][to_index(e.v)] = d[to_index(e.v)][to_index(e.u)] = 1;
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) d[i][j] = std::min(d[i][j], d[i][k] + d[k][j]);
    }
  }
  return d;
}

Relation expected(const std::vector<std::vector<double>>& d, std::uint32_t u, std::uint32_t v) {
  const auto size_of = [&](std::uint32_t x) {
    return static_cast<double>(std::ranges::count_if(d[x], [](double hops) { return std::isfinite(hops); }));
  };
  if (!std::isfinite(d[u][v])) return {kOtherComponent, std::log2(std::min(size_of(u), size_of(v)))};
  return {d[u][v] <= 2 ? kTwoHops : d[u][v] == 3 ? kThreeHops : d[u][v] == 4 ? kFourHops : kSameComponent, 0};
}

// A map with far links, a path and lone vertices: every nearness occurs.
AppearanceGraph several_components(std::uint32_t seed) {
  AppearanceGraph graph(40);
  for (const Edge& e : test::random_map(22, 1, 0.05, seed).edge_list()) graph.add_edge(e.u, e.v, 1);
  for (std::uint32_t v = 23; v < 37; ++v) graph.add_edge(vertex(v - 1), vertex(v), 1);
  return graph;
}

TEST(HopSearch, AgreesWithAllDistances) {
  std::vector<int> seen(kNearnesses, 0);
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const AppearanceGraph graph = several_components(seed);
    const auto d = distances(graph);
    HopSearch search(graph);
    for (std::uint32_t u = 0; u < graph.vertices(); ++u) {
      search.begin(vertex(u));
      for (std::uint32_t v = 0; v < graph.vertices(); ++v) {
        const Relation told = search.to(vertex(v)), truth = expected(d, u, v);
        ASSERT_EQ(told.nearness, truth.nearness) << u << " " << v << " seed " << seed;
        ASSERT_NEAR(told.smaller_component_log2, truth.smaller_component_log2, 1e-12);
        ++seen[told.nearness];
      }
    }
  }
  for (const int count : seen) EXPECT_GT(count, 50);
}

TEST(HopSearch, LeavesAnEdgeOutAsIfItWereNotThere) {
  std::vector<int> seen(kNearnesses, 0);
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const AppearanceGraph graph = several_components(seed);
    HopSearch search(graph);
    for (const Edge& left_out : graph.edge_list()) {
      AppearanceGraph without(graph.vertices());
      for (const Edge& e : graph.edge_list()) {
        if (e != left_out) without.add_edge(e.u, e.v, 1);
      }
      const Relation truth = expected(distances(without), to_index(left_out.u), to_index(left_out.v));
      const Relation told = search.without_edge(left_out.u, left_out.v);
      ASSERT_EQ(told.nearness, truth.nearness) << "seed " << seed;
      ASSERT_NEAR(told.smaller_component_log2, truth.smaller_component_log2, 1e-12);
      ++seen[told.nearness];
    }
  }
  EXPECT_GT(seen[kTwoHops], 10);
  EXPECT_GT(seen[kOtherComponent], 50) << "bridges";
}

}  // namespace
}  // namespace mapweld
