#include "core/graph/spectral_embedding.h"

#include <random>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "core/graph/disjoint_sets.h"
#include "core/graph/laplacian.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

AppearanceGraph walk_with_shortcuts(std::uint32_t vertices, std::uint32_t shortcuts) {
  std::mt19937 random(vertices);
  AppearanceGraph graph = test::path(vertices);
  for (std::uint32_t i = 0; i < shortcuts; ++i) {
    const auto u = static_cast<std::uint32_t>(random() % vertices), v = static_cast<std::uint32_t>(random() % vertices);
    if (u != v) graph.add_edge(VertexId{u}, VertexId{v}, 20);
  }
  return graph;
}

// The oracle: a dense symmetric eigensolver.
TEST(SpectralEmbedding, AgreesWithADenseSolver) {
  for (const std::uint32_t n : {2u, 5u, 40u, 90u, 300u}) {
    for (const std::uint32_t shortcuts : {0u, n / 4}) {
      const AppearanceGraph graph = walk_with_shortcuts(n, shortcuts);
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense(Eigen::MatrixXd(laplacian(graph)));
      const SpectralEmbedding embedding = spectral_embedding(graph, 6, 0);
      const Eigen::Index k = std::min<Eigen::Index>(6, n - 1);
      ASSERT_EQ(embedding.values.size(), k);
      ASSERT_EQ(embedding.vectors.rows(), n);
      ASSERT_EQ(embedding.vectors.cols(), k);
      for (Eigen::Index i = 0; i < k; ++i) {
        EXPECT_NEAR(embedding.values[i], dense.eigenvalues()[i + 1], 1e-3 * dense.eigenvalues()[i + 1]) << n;
        EXPECT_NEAR(std::abs(embedding.vectors.col(i).dot(dense.eigenvectors().col(i + 1))), 1, 1e-2) << n;
      }
    }
  }
}

TEST(SpectralEmbedding, IsTheSameEveryTime) {
  const AppearanceGraph graph = walk_with_shortcuts(400, 60);
  const SpectralEmbedding a = spectral_embedding(graph, 8), b = spectral_embedding(graph, 8);
  EXPECT_TRUE(a.values == b.values && a.vectors == b.vectors);
}

TEST(SpectralEmbedding, RefusesADisconnectedGraph) {
  AppearanceGraph graph(80);
  test::add_clique(graph, 0, 40);
  EXPECT_THROW(spectral_embedding(graph, 3), std::invalid_argument);
  EXPECT_THROW(spectral_embedding(AppearanceGraph(1), 3), std::invalid_argument);
}

TEST(DisjointSets, AreTheComponents) {
  std::mt19937 random(7);
  AppearanceGraph graph(50);
  DisjointSets sets(50);
  for (int i = 0; i < 60; ++i) {
    const auto u = static_cast<std::uint32_t>(random() % 50), v = static_cast<std::uint32_t>(random() % 50);
    const Components before = connected_components(graph);
    EXPECT_EQ(sets.join(u, v), before.component_of[u] != before.component_of[v]);
    if (u != v) graph.add_edge(VertexId{u}, VertexId{v}, 1);
    const Components after = connected_components(graph);
    for (std::uint32_t a = 0; a < 50; ++a) {
      EXPECT_EQ(sets.size_of(a), after.sizes[after.component_of[a]]);
      EXPECT_EQ(sets.root(a) == sets.root(0), after.component_of[a] == after.component_of[0]);
    }
  }
}

}  // namespace
}  // namespace mapweld
