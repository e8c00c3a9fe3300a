#include "core/graph/algebraic_connectivity.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <string>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/graph/degrees.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

constexpr double kPi = std::numbers::pi;

// The oracle: a dense symmetric eigensolver.
double dense_connectivity(const AppearanceGraph& graph, Weighting weighting) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(laplacian(graph, weighting)),
                                                              Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[1];
}

AlgebraicConnectivityOptions only_cholesky() {
  AlgebraicConnectivityOptions options;
  options.dense_up_to = 0;
  options.max_factor_work_per_vertex = 1e18;
  return options;
}

AlgebraicConnectivityOptions only_iteration() {
  AlgebraicConnectivityOptions options;
  options.dense_up_to = 0;
  options.max_factor_work_per_vertex = 0;
  return options;
}

void expect_relative(double actual, double expected, double tolerance, const std::string& what) {
  EXPECT_NEAR(actual, expected, tolerance * expected) << what;
}

TEST(AlgebraicConnectivity, OfSmallOrEmptyGraphsIsZero) {
  EXPECT_EQ(algebraic_connectivity(AppearanceGraph()).value, 0.0);
  EXPECT_EQ(algebraic_connectivity(AppearanceGraph(1)).value, 0.0);
  EXPECT_EQ(algebraic_connectivity(AppearanceGraph(2)).value, 0.0);
  expect_relative(algebraic_connectivity(test::path(2)).value, 2.0, 1e-14, "one edge");
}

TEST(AlgebraicConnectivity, IsExactlyZeroWhenDisconnected) {
  AppearanceGraph graph(500);
  test::add_clique(graph, 0, 250);
  test::add_clique(graph, 250, 249);
  const AlgebraicConnectivity result = algebraic_connectivity(graph);
  EXPECT_EQ(result.value, 0.0);
  EXPECT_EQ(result.fiedler.size(), 0);
}

// Fiedler 1973, section 4, and the two-clique graph by its symmetric halves.
TEST(AlgebraicConnectivity, HasTheClosedForms) {
  for (const auto& options : {AlgebraicConnectivityOptions{}, only_cholesky(), only_iteration()}) {
    for (const std::uint32_t n : {5u, 30u, 200u, 1000u}) {
      const double c = 1.0 - std::cos(kPi / n);
      const double exact_path = 4 * std::pow(std::sin(kPi / (2.0 * n)), 2);
      expect_relative(exact_path, 2 * c, 1e-6, "the formula itself");
      const std::string size = " of " + std::to_string(n);
      expect_relative(algebraic_connectivity(test::path(n), options).value, exact_path, 1e-12, "path" + size);
      expect_relative(algebraic_connectivity(test::cycle(n), options).value, 4 * std::pow(std::sin(kPi / n), 2), 1e-12,
                      "cycle" + size);
      expect_relative(algebraic_connectivity(test::star(n), options).value, 1.0, 1e-12, "star" + size);
      if (n <= 200) {
        expect_relative(algebraic_connectivity(test::complete(n), options).value, n, 1e-12, "complete" + size);
        // x = (1, ..., 1, t, -t, -1, ..., -1): lambda = 1 - t, lambda^2 - (n + 2) lambda + 2 = 0.
        const double exact_barbell = 4 / (n + 2 + std::sqrt((n + 2.0) * (n + 2.0) - 8));
        expect_relative(algebraic_connectivity(test::barbell(n), options).value, exact_barbell, 1e-12,
                        "barbell" + size);
      }
    }
  }
}

TEST(AlgebraicConnectivity, AgreesWithADenseSolver) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const AppearanceGraph graph = seed % 2 == 0 ? test::random_map(40 + 20 * seed, 3, 0.02 * seed, seed)
                                                : test::random_graph(30 + 10 * seed, 0.25, seed);
    for (const Weighting weighting : {Weighting::kUnweighted, Weighting::kInliers}) {
      const double expected = dense_connectivity(graph, weighting);
      if (expected < 1e-9) continue;
      for (auto options : {AlgebraicConnectivityOptions{}, only_cholesky(), only_iteration()}) {
        options.weighting = weighting;
        // The dense solver itself is exact to about n eps |L|.
        EXPECT_NEAR(algebraic_connectivity(graph, options).value, expected, 1e-10 + 1e-10 * expected)
            << "seed " << seed << " vertices " << graph.vertices();
      }
    }
  }
}

TEST(AlgebraicConnectivity, GivesTheFiedlerVector) {
  const AppearanceGraph graph = test::random_map(700, 3, 0.01, 5);
  const AlgebraicConnectivity result = algebraic_connectivity(graph);
  ASSERT_EQ(result.fiedler.size(), 700);
  EXPECT_NEAR(result.fiedler.norm(), 1.0, 1e-12);
  EXPECT_NEAR(result.fiedler.sum(), 0.0, 1e-10);
  const Eigen::VectorXd defect = laplacian(graph) * result.fiedler - result.value * result.fiedler;
  EXPECT_LT(defect.norm(), 1e-8 * result.value);
  EXPECT_NEAR(defect.norm(), result.residual, 1e-12);
  Eigen::Index greatest = 0;
  result.fiedler.cwiseAbs().maxCoeff(&greatest);
  EXPECT_GT(result.fiedler[greatest], 0);
}

TEST(AlgebraicConnectivity, IsRepeatableBitForBit) {
  const AppearanceGraph graph = test::random_map(900, 3, 0.02, 8);
  const AlgebraicConnectivity a = algebraic_connectivity(graph), b = algebraic_connectivity(graph);
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.fiedler, b.fiedler);
}

TEST(AlgebraicConnectivity, OnlyGrowsWithEdgesAndStaysUnderFiedlersCeiling) {
  std::mt19937 random(4);
  AppearanceGraph graph = test::path(60);
  double before = algebraic_connectivity(graph).value;
  for (int k = 0; k < 300; ++k) {
    const VertexId u{static_cast<std::uint32_t>(random() % 60)}, v{static_cast<std::uint32_t>(random() % 60)};
    if (u == v || !graph.add_edge(u, v, 1)) continue;
    const double now = algebraic_connectivity(graph).value;
    EXPECT_GE(now, before * (1 - 1e-12));
    EXPECT_LE(now, 60.0 / 59.0 * min_degree(graph) * (1 + 1e-12));
    before = now;
  }
  EXPECT_GT(before, 1.0);
}

TEST(AlgebraicConnectivity, TakesAnEdgeWithoutInliersForAbsent) {
  AppearanceGraph graph(3);
  graph.add_edge(VertexId{0}, VertexId{1}, 20);
  graph.add_edge(VertexId{1}, VertexId{2}, 0);
  AlgebraicConnectivityOptions options;
  options.weighting = Weighting::kInliers;
  EXPECT_EQ(algebraic_connectivity(graph, options).value, 0.0);
  EXPECT_GT(algebraic_connectivity(graph).value, 0.0);
}

TEST(AlgebraicConnectivity, LeavesTheFactorWhenItWouldFill) {
  const AppearanceGraph expander = test::random_graph(2000, 0.005, 2);
  const AlgebraicConnectivity spared = algebraic_connectivity(expander);
  EXPECT_EQ(spared.solver, EigenSolver::kIteration);
  const AlgebraicConnectivity planar_like = algebraic_connectivity(test::random_map(2000, 3, 0, 2));
  EXPECT_EQ(planar_like.solver, EigenSolver::kCholesky);
  expect_relative(spared.value, algebraic_connectivity(expander, only_cholesky()).value, 1e-9, "both solvers");
}

TEST(LargestComponent, IsJudgedAlone) {
  AppearanceGraph graph(40);
  test::add_clique(graph, 25, 10);
  for (std::uint32_t v = 0; v < 20; ++v) graph.add_edge(VertexId{v}, VertexId{v + 1}, 1);
  const LargestComponentConnectivity largest = largest_component_connectivity(graph);
  EXPECT_EQ(largest.components, 1u + 1u + 9u);
  ASSERT_EQ(largest.vertices.size(), 21u);
  EXPECT_EQ(largest.vertices.front(), VertexId{0});
  expect_relative(largest.connectivity.value, algebraic_connectivity(test::path(21)).value, 1e-12, "path of 21");
  EXPECT_EQ(largest_component_connectivity(AppearanceGraph()).components, 0u);
}

TEST(CanHaveChanged, IsNeverWrongWhenItSaysNo) {
  int no = 0, yes = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    AppearanceGraph graph = test::random_map(40 + seed, 2, 0.02, seed);
    const LargestComponentConnectivity before = largest_component_connectivity(graph);
    std::mt19937 random(seed);
    std::vector<std::pair<VertexId, VertexId>> added;
    for (int k = 0; k < 6; ++k) {
      const VertexId u{static_cast<std::uint32_t>(random() % graph.vertices())};
      const VertexId v{(to_index(u) + 2 + static_cast<std::uint32_t>(random() % 4)) % graph.vertices()};
      if (!graph.add_edge(u, v, 1)) continue;
      added.emplace_back(u, v);
      const double growth = algebraic_connectivity(graph).value / before.connectivity.value - 1;
      for (const double least : {1e-7, 1e-3, 1e-2, 0.1, 1.0}) {
        if (can_have_changed(before, added, least)) {
          ++yes;
        } else {
          ++no;
          EXPECT_LE(growth, least * (1 + 1e-6) + 1e-11);
        }
      }
    }
  }
  EXPECT_GT(no, 100);
  EXPECT_GT(yes, 100);
}

TEST(CanHaveChanged, SaysYesWhenComponentsMayHave) {
  AppearanceGraph graph(8);
  test::add_clique(graph, 0, 5);
  const LargestComponentConnectivity before = largest_component_connectivity(graph);
  using Added = std::vector<std::pair<VertexId, VertexId>>;
  EXPECT_FALSE(can_have_changed(before, Added{}));
  EXPECT_TRUE(can_have_changed(before, Added{{VertexId{0}, VertexId{6}}}));
  EXPECT_TRUE(can_have_changed(before, Added{{VertexId{6}, VertexId{7}}}));
  const LargestComponentConnectivity single = largest_component_connectivity(AppearanceGraph(3));
  EXPECT_TRUE(can_have_changed(single, Added{{VertexId{0}, VertexId{1}}}));
}

}  // namespace
}  // namespace mapweld
