#include "core/merge/spectral/connectivity_gain.h"

#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "core/graph/laplacian.h"

namespace mapweld {
namespace {

// A walk with short cuts of up to `reach` images.
AppearanceGraph walk(std::uint32_t vertices, std::uint32_t reach, std::uint32_t seed) {
  std::mt19937 random(seed);
  AppearanceGraph graph(vertices);
  for (std::uint32_t v = 1; v < vertices; ++v) {
    graph.add_edge(VertexId{v - 1}, VertexId{v}, 20);
    const std::uint32_t back = 2 + static_cast<std::uint32_t>(random() % reach);
    if (back <= v && random() % 2 == 0) graph.add_edge(VertexId{v - back}, VertexId{v}, 20);
  }
  return graph;
}

// The oracle: b^T (L + weight e e^T)^+ ^power b with a dense pseudo-inverse.
double dense_gain(const AppearanceGraph& graph, const Eigen::VectorXd& e, double weight, std::uint32_t u,
                  std::uint32_t v, int power) {
  Eigen::MatrixXd l(laplacian(graph));
  l += weight * e * e.transpose();
  const Eigen::Index n = l.rows();
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Constant(n, n, 1.0 / static_cast<double>(n));
  const Eigen::MatrixXd inverse = (l + ones).inverse() - ones;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  b[u] += 1;
  b[v] -= 1;
  Eigen::VectorXd x = b;
  for (int i = 0; i < power; ++i) x = inverse * x;
  return b.dot(x);
}

TEST(ConnectivityGain, WithEveryDimensionIsExact) {
  const AppearanceGraph graph = walk(30, 5, 1);
  for (const int power : {2, 3}) {
    ConnectivityGain gain(graph, {.dimensions = 29, .power = power});
    Eigen::VectorXd e = Eigen::VectorXd::Zero(30);
    for (std::uint32_t v = 1; v < 30; ++v) {
      const double expected = dense_gain(graph, e, 0, 0, v, power);
      EXPECT_NEAR(gain.gain(VertexId{0}, VertexId{v}), expected, 1e-8 * expected);
    }
    gain.expect(VertexId{2}, VertexId{27}, 0.3);
    e[2] = 1;
    e[27] = -1;
    for (std::uint32_t v = 1; v < 30; ++v) {
      const double expected = dense_gain(graph, e, 0.3, 0, v, power);
      EXPECT_NEAR(gain.gain(VertexId{0}, VertexId{v}), expected, 1e-8 * expected);
    }
  }
}

TEST(ConnectivityGain, AnExpectedEdgeTakesTheGainOfOthersOverTheSameGap) {
  ConnectivityGain gain(walk(300, 4, 2), {});
  const double before = gain.gain(VertexId{1}, VertexId{298}), elsewhere = gain.gain(VertexId{100}, VertexId{140});
  EXPECT_GT(before, 10 * elsewhere);
  gain.expect(VertexId{2}, VertexId{296}, 1.0);
  EXPECT_LT(gain.gain(VertexId{1}, VertexId{298}), before / 100);
  EXPECT_GT(gain.gain(VertexId{100}, VertexId{200}), gain.gain(VertexId{1}, VertexId{298}));
}

TEST(ConnectivityGain, FollowsComponentsAsEdgesArrive) {
  std::mt19937 random(3);
  AppearanceGraph graph(60);
  for (std::uint32_t v = 1; v < 25; ++v) graph.add_edge(VertexId{v - 1}, VertexId{v}, 20);
  for (std::uint32_t v = 31; v < 45; ++v) graph.add_edge(VertexId{v - 1}, VertexId{v}, 20);
  ConnectivityGain gain(graph, {});
  for (int i = 0; i < 60; ++i) {
    const VertexId u{static_cast<std::uint32_t>(random() % 60)}, v{static_cast<std::uint32_t>(random() % 60)};
    if (u == v || !graph.add_edge(u, v, 20)) continue;
    gain.add(u, v);
    const Components components = connected_components(graph);
    for (std::uint32_t a = 0; a < 60; ++a) {
      EXPECT_EQ(gain.component_size(gain.component(VertexId{a})), components.sizes[components.component_of[a]]);
      EXPECT_EQ(gain.is_embedded(VertexId{a}), components.component_of[a] == components.component_of[0]);
      for (std::uint32_t b = 0; b < a; ++b) {
        EXPECT_EQ(gain.component(VertexId{a}) == gain.component(VertexId{b}),
                  components.component_of[a] == components.component_of[b]);
      }
    }
  }
}

TEST(ConnectivityGain, OfAVertexThatHangsOnAnotherIsThatOfTheOther) {
  AppearanceGraph graph = walk(40, 3, 4);
  const VertexId fresh = graph.add_vertex();
  ConnectivityGain gain(graph, {});
  EXPECT_FALSE(gain.is_embedded(fresh));
  gain.add(VertexId{10}, fresh);
  ASSERT_TRUE(gain.is_embedded(fresh));
  EXPECT_EQ(gain.gain(fresh, VertexId{35}), gain.gain(VertexId{10}, VertexId{35}));
  EXPECT_EQ(gain.gain(fresh, VertexId{10}), 0);
}

}  // namespace
}  // namespace mapweld
