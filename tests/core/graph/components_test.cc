#include "core/graph/components.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

TEST(Components, AreNumberedByTheirLowestVertex) {
  AppearanceGraph graph(6);
  graph.add_edge(VertexId{4}, VertexId{1}, 1);
  graph.add_edge(VertexId{5}, VertexId{0}, 1);
  const Components components = connected_components(graph);
  EXPECT_EQ(components.component_of, (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 0}));
  EXPECT_EQ(components.sizes, (std::vector<std::uint32_t>{2, 2, 1, 1}));
  EXPECT_EQ(components.largest(), 0u);  // a tie goes to the lowest vertex
  EXPECT_EQ(components.vertices_of(1), (std::vector<VertexId>{VertexId{1}, VertexId{4}}));
}

TEST(Components, OfNothingAreNone) {
  EXPECT_EQ(connected_components(AppearanceGraph()).count(), 0u);
  EXPECT_THROW(Components{}.largest(), std::invalid_argument);
}

// Warshall's transitive closure says who reaches whom.
TEST(Components, AgreeWithTransitiveClosure) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    const std::uint32_t n = 25;
    const AppearanceGraph graph = test::random_graph(n, 0.05, seed);
    std::vector<std::vector<bool>> reaches(n, std::vector<bool>(n, false));
    for (std::uint32_t v = 0; v < n; ++v) reaches[v][v] = true;
    for (const Edge& e : graph.edge_list()) {
      reaches[to_index(e.u)][to_index(e.v)] = reaches[to_index(e.v)][to_index(e.u)] = true;
    }
    for (std::uint32_t k = 0; k < n; ++k) {
      for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
          if (reaches[i][k] && reaches[k][j]) reaches[i][j] = true;
        }
      }
    }
    const Components components = connected_components(graph);
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = 0; j < n; ++j) {
        EXPECT_EQ(components.component_of[i] == components.component_of[j], reaches[i][j]);
      }
    }
  }
}

TEST(InducedSubgraph, KeepsTheEdgesInside) {
  const AppearanceGraph graph = test::cycle(6);
  const std::vector<VertexId> kept{VertexId{5}, VertexId{0}, VertexId{2}};
  const AppearanceGraph sub = induced_subgraph(graph, kept);
  EXPECT_EQ(sub.edge_list(), (std::vector<Edge>{{VertexId{0}, VertexId{1}, 1}}));
}

}  // namespace
}  // namespace mapweld
