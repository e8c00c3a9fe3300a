#include "core/graph/appearance_graph.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "core/graph/degrees.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

TEST(AppearanceGraph, GrowsByVerticesAndEdges) {
  AppearanceGraph graph(2);
  EXPECT_EQ(graph.add_vertex(), VertexId{2});
  EXPECT_TRUE(graph.add_edge(VertexId{2}, VertexId{0}, 40));
  EXPECT_EQ(graph.vertices(), 3u);
  EXPECT_EQ(graph.edges(), 1u);
  EXPECT_TRUE(graph.has_edge(VertexId{0}, VertexId{2}));
  EXPECT_FALSE(graph.has_edge(VertexId{0}, VertexId{1}));
  EXPECT_EQ(graph.edge_list(), (std::vector<Edge>{{VertexId{0}, VertexId{2}, 40}}));
}

TEST(AppearanceGraph, RefusesASecondEdgeBetweenTheSameVertices) {
  AppearanceGraph graph(2);
  EXPECT_TRUE(graph.add_edge(VertexId{0}, VertexId{1}, 12));
  const AppearanceGraph before = graph;
  EXPECT_FALSE(graph.add_edge(VertexId{1}, VertexId{0}, 99));
  EXPECT_EQ(graph, before);
}

TEST(AppearanceGraph, RefusesLoopsAndUnknownVertices) {
  AppearanceGraph graph(2);
  EXPECT_THROW(graph.add_edge(VertexId{1}, VertexId{1}, 1), std::invalid_argument);
  EXPECT_THROW(graph.add_edge(VertexId{0}, VertexId{2}, 1), std::invalid_argument);
  EXPECT_EQ(graph.edges(), 0u);
}

TEST(AppearanceGraph, CountsDegrees) {
  const AppearanceGraph graph = test::star(5);
  EXPECT_EQ(degrees(graph), (std::vector<std::uint32_t>{4, 1, 1, 1, 1}));
  EXPECT_EQ(min_degree(graph), 1u);
  EXPECT_EQ(min_degree(AppearanceGraph()), 0u);
}

TEST(AppearanceGraph, ListsEveryEdgeOnceInOrder) {
  const AppearanceGraph graph = test::random_graph(40, 0.2, 3);
  const std::vector<Edge> edges = graph.edge_list();
  EXPECT_EQ(edges.size(), graph.edges());
  EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
  for (const Edge& e : edges) EXPECT_LT(e.u, e.v);
  const AppearanceGraph again(40, edges);
  EXPECT_EQ(again.edge_list(), edges);
}

}  // namespace
}  // namespace mapweld
