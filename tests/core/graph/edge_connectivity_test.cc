#include "core/graph/edge_connectivity.h"

#include <algorithm>
#include <bit>
#include <queue>

#include <gtest/gtest.h>

#include "core/graph/degrees.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

// The oracle for up to 16 vertices: every way to cut the vertices in two.
std::uint32_t cut_by_enumeration(const AppearanceGraph& graph) {
  const std::vector<Edge> edges = graph.edge_list();
  std::uint32_t best = 0xFFFFFFFF;
  for (std::uint32_t side = 1; side < (1u << (graph.vertices() - 1)); ++side) {
    std::uint32_t cut = 0;
    for (const Edge& e : edges) cut += ((side >> to_index(e.u)) & 1) != ((side >> to_index(e.v)) & 1);
    best = std::min(best, cut);
  }
  return best;
}

// The oracle for larger ones: the least maximum flow from vertex 0 to any other, along breadth first paths.
std::uint32_t cut_by_flows(const AppearanceGraph& graph) {
  const std::uint32_t n = graph.vertices();
  std::uint32_t best = min_degree(graph);
  for (std::uint32_t sink = 1; sink < n; ++sink) {
    std::vector<std::vector<int>> capacity(n, std::vector<int>(n, 0));
    for (const Edge& e : graph.edge_list()) {
      capacity[to_index(e.u)][to_index(e.v)] = capacity[to_index(e.v)][to_index(e.u)] = 1;
    }
    std::uint32_t flow = 0;
    for (;; ++flow) {
      std::vector<int> from(n, -1);
      std::queue<std::uint32_t> queue({0});
      from[0] = 0;
      while (!queue.empty() && from[sink] < 0) {
        const std::uint32_t u = queue.front();
        queue.pop();
        for (std::uint32_t v = 0; v < n; ++v) {
          if (from[v] < 0 && capacity[u][v] > 0) {
            from[v] = static_cast<int>(u);
            queue.push(v);
          }
        }
      }
      if (from[sink] < 0) break;
      for (std::uint32_t v = sink; v != 0; v = from[v]) {
        --capacity[from[v]][v];
        ++capacity[v][from[v]];
      }
    }
    best = std::min(best, flow);
  }
  return best;
}

TEST(EdgeConnectivity, HasTheClosedForms) {
  EXPECT_EQ(edge_connectivity(AppearanceGraph()), 0u);
  EXPECT_EQ(edge_connectivity(AppearanceGraph(1)), 0u);
  EXPECT_EQ(edge_connectivity(AppearanceGraph(2)), 0u);
  EXPECT_EQ(edge_connectivity(test::path(2)), 1u);
  EXPECT_EQ(edge_connectivity(test::path(100)), 1u);
  EXPECT_EQ(edge_connectivity(test::star(50)), 1u);
  EXPECT_EQ(edge_connectivity(test::cycle(100)), 2u);
  EXPECT_EQ(edge_connectivity(test::complete(30)), 29u);
  EXPECT_EQ(edge_connectivity(test::barbell(20)), 1u);
  EXPECT_EQ(edge_connectivity(test::grid(9, 7)), 2u);
}

TEST(EdgeConnectivity, FindsACutThatNoDegreeShows) {
  AppearanceGraph graph(60);
  test::add_clique(graph, 0, 30);
  test::add_clique(graph, 30, 30);
  for (std::uint32_t k = 0; k < 5; ++k) graph.add_edge(VertexId{k}, VertexId{30 + 2 * k}, 1);
  EXPECT_EQ(edge_connectivity(graph), 5u);
}

TEST(EdgeConnectivity, AgreesWithEveryCutOfSmallGraphs) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    const AppearanceGraph graph = test::random_graph(4 + seed % 9, 0.25 + 0.05 * (seed % 12), seed);
    EXPECT_EQ(edge_connectivity(graph), cut_by_enumeration(graph)) << "seed " << seed;
  }
}

TEST(EdgeConnectivity, AgreesWithMaximumFlows) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    AppearanceGraph graph = seed % 2 == 0 ? test::random_map(60, 4, 0.1, seed) : test::random_graph(50, 0.3, seed);
    EXPECT_EQ(edge_connectivity(graph), cut_by_flows(graph)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace mapweld
