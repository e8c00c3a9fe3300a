#include "core/graph/route.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

VertexId v(std::uint32_t number) { return VertexId{number}; }

AppearanceGraph graph_of(std::uint32_t vertices, const std::vector<Edge>& edges) { return {vertices, edges}; }

std::uint32_t weight(const AppearanceGraph& graph, VertexId a, VertexId b) {
  for (const Neighbour& next : graph.neighbours(a)) {
    if (next.vertex == b) return next.weight;
  }
  ADD_FAILURE() << "no such edge";
  return 0;
}

// The best of all simple paths: (weakest edge, fewest edges).
std::optional<std::pair<std::uint32_t, std::size_t>> by_trying_all(const AppearanceGraph& graph, VertexId from,
                                                                   VertexId to) {
  std::optional<std::pair<std::uint32_t, std::size_t>> best;
  std::vector<VertexId> path = {from};
  const std::function<void(std::uint32_t)> walk = [&](std::uint32_t weakest) {
    if (path.back() == to) {
      const std::size_t length = path.size() - 1;
      if (!best || weakest > best->first || (weakest == best->first && length < best->second)) {
        best = {weakest, length};
      }
      return;
    }
    for (const Neighbour& next : graph.neighbours(path.back())) {
      if (std::ranges::find(path, next.vertex) != path.end()) continue;
      path.push_back(next.vertex);
      walk(std::min(weakest, next.weight));
      path.pop_back();
    }
  };
  walk(UINT32_MAX);
  return best;
}

TEST(WidestRoute, PrefersStrongEdgesToAShortWay) {
  const AppearanceGraph graph = graph_of(4, {{v(0), v(3), 12}, {v(0), v(1), 90}, {v(1), v(2), 40}, {v(2), v(3), 80}});
  const Route route = widest_route(graph, v(0), v(3)).value();
  EXPECT_EQ(route.vertices, (std::vector<VertexId>{v(0), v(1), v(2), v(3)}));
  EXPECT_EQ(route.min_weight, 40u);
}

TEST(WidestRoute, OfEquallyWideWaysTakesTheShortestThenTheLowest) {
  const AppearanceGraph graph = graph_of(
      5, {{v(0), v(1), 50}, {v(0), v(2), 99}, {v(0), v(3), 50}, {v(1), v(4), 50}, {v(2), v(3), 99}, {v(3), v(4), 50}});
  EXPECT_EQ(widest_route(graph, v(0), v(4))->vertices, (std::vector<VertexId>{v(0), v(1), v(4)}));
}

TEST(WidestRoute, KnowsItsEnds) {
  const AppearanceGraph graph = graph_of(3, {{v(0), v(1), 5}});
  const Route here = widest_route(graph, v(2), v(2)).value();
  EXPECT_EQ(here.vertices, std::vector<VertexId>{v(2)});
  EXPECT_EQ(here.min_weight, 0u);
  EXPECT_EQ(widest_route(graph, v(0), v(2)), std::nullopt);
  EXPECT_THROW(widest_route(graph, v(0), v(3)), std::invalid_argument);
}

TEST(WidestRoute, IsTheBestOfAllPaths) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    const auto n = static_cast<std::uint32_t>(2 + random() % 7);
    AppearanceGraph graph(n);
    for (std::uint32_t a = 0; a < n; ++a) {
      for (std::uint32_t b = a + 1; b < n; ++b) {
        if (random() % 3 == 0) graph.add_edge(v(a), v(b), static_cast<std::uint32_t>(1 + random() % 5));
      }
    }
    const VertexId from = v(0);
    const VertexId to = v(n - 1);
    const auto best = by_trying_all(graph, from, to);
    const auto route = widest_route(graph, from, to);
    ASSERT_EQ(route.has_value(), best.has_value());
    if (!route) continue;
    EXPECT_EQ(route->vertices.front(), from);
    EXPECT_EQ(route->vertices.back(), to);
    std::uint32_t weakest = UINT32_MAX;
    for (std::size_t i = 1; i < route->vertices.size(); ++i) {
      weakest = std::min(weakest, weight(graph, route->vertices[i - 1], route->vertices[i]));
    }
    EXPECT_EQ(weakest, best->first);
    EXPECT_EQ(route->min_weight, best->first);
    EXPECT_EQ(route->vertices.size() - 1, best->second);
  }
}

}  // namespace
}  // namespace mapweld
