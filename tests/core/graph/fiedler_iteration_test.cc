#include "core/graph/fiedler_iteration.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "core/graph/approximate_cholesky.h"
#include "core/graph/sparsify.h"
#include "tests/core/graph/laplacian_oracle.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

std::vector<LaplacianEdge> random_weights(std::vector<LaplacianEdge> edges, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (LaplacianEdge& e : edges) e.weight = 0.02 + static_cast<double>(random() % 1000) / 1000;
  return edges;
}

Matrix applied(const ApproximateCholesky& factor, int n) {
  Matrix result(n, n);
  for (int v = 0; v < n; ++v) result.col(v) = factor.solve(Vector::Unit(n, v));
  return result;
}

AppearanceGraph random_tree(std::uint32_t n, std::uint32_t seed) {
  std::mt19937 random(seed);
  AppearanceGraph tree(n);
  for (std::uint32_t v = 1; v < n; ++v)
    tree.add_edge(VertexId{v}, VertexId{static_cast<std::uint32_t>(random() % v)}, 1);
  return tree;
}

TEST(ApproximateCholesky, IsExactOnTreesAndCycles) {
  for (const AppearanceGraph& graph : {random_tree(60, 3), test::path(40), test::cycle(30), test::star(20)}) {
    const int n = static_cast<int>(graph.vertices());
    const std::vector<LaplacianEdge> edges = random_weights(test::unit_edges(graph), 5);
    const Matrix inverse = applied(ApproximateCholesky(n, edges), n);
    const Matrix projector = test::dense_laplacian(n, edges) * inverse;
    const Matrix expected = Matrix::Identity(n, n) - Matrix::Constant(n, n, 1.0 / n);
    EXPECT_LT((projector - expected).norm(), 1e-9);
  }
}

TEST(ApproximateCholesky, IsASymmetricOperatorNearTheInverse) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const AppearanceGraph graph =
        seed % 2 == 0 ? test::random_map(150, 4, 0.2, seed) : test::random_map(150, 2, 0.9, seed);
    const int n = static_cast<int>(graph.vertices());
    const std::vector<LaplacianEdge> edges = random_weights(test::unit_edges(graph), seed);
    const ApproximateCholesky factor(n, edges);
    const Matrix inverse = applied(factor, n);
    EXPECT_LT((inverse - inverse.transpose()).norm(), 1e-10 * inverse.norm());
    EXPECT_LT((inverse * Vector::Ones(n)).norm(), 1e-10 * inverse.norm());
    // Eigenvalues of the preconditioned operator on the complement of 1.
    const Eigen::SelfAdjointEigenSolver<Matrix> laplacian(test::dense_laplacian(n, edges));
    const Matrix root = laplacian.eigenvectors() * laplacian.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
                        laplacian.eigenvectors().transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix> both(root * inverse * root, Eigen::EigenvaluesOnly);
    EXPECT_LT(both.eigenvalues()[n - 1] / both.eigenvalues()[1], 20) << "seed " << seed;
  }
}

TEST(Sparsify, KeepsTheGraphConnectedAndItsWeight) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    AppearanceGraph graph(400);
    for (const std::uint32_t first : {0u, 200u}) {  // two random graphs, joined by one bridge
      const AppearanceGraph part = test::random_graph(200, 0.3, seed + first);
      for (const Edge& e : part.edge_list()) {
        graph.add_edge(VertexId{to_index(e.u) + first}, VertexId{to_index(e.v) + first}, 1);
      }
    }
    graph.add_edge(VertexId{17}, VertexId{316}, 1);
    const std::vector<LaplacianEdge> edges = test::unit_edges(graph);
    const std::vector<LaplacianEdge> kept = sparsify(400, edges, 3);
    EXPECT_LT(kept.size(), 4 * 400 + 200u);
    EXPECT_GT(kept.size(), 2 * 400u);
    EXPECT_GT(test::dense_connectivity(400, kept), 1e-6);
    const auto total = [](const std::vector<LaplacianEdge>& all) {
      return std::accumulate(all.begin(), all.end(), 0.0,
                             [](double sum, const LaplacianEdge& e) { return sum + e.weight; });
    };
    EXPECT_NEAR(total(kept), total(edges), 0.1 * total(edges));
  }
  const std::vector<LaplacianEdge> thin = test::unit_edges(test::grid(10, 10));
  EXPECT_EQ(sparsify(100, thin, 10).size(), thin.size());
}

AppearanceGraph sample(std::uint32_t seed) {
  switch (seed % 6) {
    case 0:
      return test::path(3 + seed);
    case 1:
      return test::grid(4 + seed % 9, 5 + seed % 7);
    case 2:
      return test::random_map(30 + 2 * seed, 3, 0.01, seed);
    case 3:
      return test::random_map(30 + 2 * seed, 2, 0.9, seed);
    case 4:
      return test::barbell(4 + seed % 20);
    default:
      return test::complete(2 + seed % 30);
  }
}

TEST(FiedlerIteration, AgreesWithADenseSolver) {
  for (std::uint32_t seed = 0; seed < 120; ++seed) {
    const AppearanceGraph graph = sample(seed);
    const int n = static_cast<int>(graph.vertices());
    for (const bool weighted : {false, true}) {
      std::vector<LaplacianEdge> edges = test::unit_edges(graph);
      if (weighted) edges = random_weights(std::move(edges), seed);
      const FiedlerIteration found = iterate_to_fiedler(n, edges, ApproximateCholesky(n, sparsify(n, edges, 3)));
      const double expected = test::dense_connectivity(n, edges);
      EXPECT_TRUE(found.converged) << "seed " << seed;
      EXPECT_NEAR(found.value, expected, 1e-8 * expected + 1e-13) << "seed " << seed << " vertices " << n;
      EXPECT_LT(found.residual, 2e-8 * found.value + 1e-12);
      EXPECT_NEAR(found.vector.norm(), 1, 1e-12);
      EXPECT_NEAR(found.vector.sum(), 0, 1e-10);
    }
  }
}

TEST(FiedlerIteration, IsAnUpperBoundHoweverEarlyItStops) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const AppearanceGraph graph = sample(seed);
    const int n = static_cast<int>(graph.vertices());
    const std::vector<LaplacianEdge> edges = random_weights(test::unit_edges(graph), seed);
    const ApproximateCholesky factor(n, edges);
    const double exact = test::dense_connectivity(n, edges);
    for (const int steps : {1, 2, 3, 5, 9, 14}) {
      const FiedlerIteration found = iterate_to_fiedler(n, edges, factor, {}, {.max_iterations = steps});
      EXPECT_GE(found.value, exact * (1 - 1e-12) - 1e-13);
      EXPECT_LE(found.iterations, steps);
    }
  }
}

// A start that is another eigenvector has no residual at all, and must not be taken for the answer.
TEST(FiedlerIteration, IsNotCaughtByAnotherEigenvector) {
  for (const AppearanceGraph& graph : {test::grid(12, 7), test::path(50), test::barbell(20)}) {
    const int n = static_cast<int>(graph.vertices());
    const std::vector<LaplacianEdge> edges = test::unit_edges(graph);
    const Eigen::SelfAdjointEigenSolver<Matrix> dense(test::dense_laplacian(n, edges));
    const ApproximateCholesky factor(n, edges);
    for (const int k : {2, 3, 5, n - 1}) {
      const FiedlerIteration found = iterate_to_fiedler(n, edges, factor, dense.eigenvectors().col(k));
      EXPECT_NEAR(found.value, dense.eigenvalues()[1], 1e-9) << "start " << k;
    }
    const FiedlerIteration constant = iterate_to_fiedler(n, edges, factor, Vector::Ones(n));
    EXPECT_NEAR(constant.value, dense.eigenvalues()[1], 1e-9);
  }
}

TEST(FiedlerIteration, IsRepeatableBitForBit) {
  const std::vector<LaplacianEdge> edges = random_weights(test::unit_edges(test::random_map(800, 4, 0.5, 1)), 2);
  const auto run = [&edges] {
    return iterate_to_fiedler(800, edges, ApproximateCholesky(800, sparsify(800, edges, 2)));
  };
  const FiedlerIteration a = run(), b = run();
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.vector, b.vector);
}

}  // namespace
}  // namespace mapweld
