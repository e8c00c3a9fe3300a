// Levels and curves against dense eigenvalues at every single edge.
#include "server/evaluation/curves.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <set>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld::server::evaluation {
namespace {

using test::make_toy_merge;
using test::toy_world;

std::uint32_t vertices_of(const MergeInput& input) {
  std::size_t count = 0;
  for (const MergeMember& member : input.members) count += member.vertices.size();
  return static_cast<std::uint32_t>(count);
}

// The largest component by flooding: ties go to the one with the lowest vertex.
std::vector<std::uint32_t> largest_component(const MergeInput& input, const std::vector<RecordedEdge>& edges) {
  const std::uint32_t n = vertices_of(input);
  std::vector<std::set<std::uint32_t>> neighbours(n);
  const auto link = [&](VertexId u, VertexId v) {
    neighbours[to_index(u)].insert(to_index(v));
    neighbours[to_index(v)].insert(to_index(u));
  };
  for (const Edge& e : input.inner_edges) link(e.u, e.v);
  for (const RecordedEdge& e : edges) link(e.u, e.v);
  std::vector<bool> seen(n, false);
  std::vector<std::uint32_t> best;
  for (std::uint32_t start = 0; start < n; ++start) {
    if (seen[start]) continue;
    std::vector<std::uint32_t> component{start};
    seen[start] = true;
    for (std::size_t i = 0; i < component.size(); ++i) {
      for (const std::uint32_t next : neighbours[component[i]]) {
        if (seen[next]) continue;
        seen[next] = true;
        component.push_back(next);
      }
    }
    if (component.size() > best.size()) best = component;
  }
  std::ranges::sort(best);
  return best;
}

double dense_connectivity(const MergeInput& input, const std::vector<std::uint32_t>& component,
                          std::span<const RecordedEdge> edges) {
  const auto n = static_cast<Eigen::Index>(component.size());
  if (n < 2) return 0;
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(n, n);
  const auto link = [&](VertexId u, VertexId v) {
    const auto iu = std::ranges::lower_bound(component, to_index(u)),
               iv = std::ranges::lower_bound(component, to_index(v));
    if (iu == component.end() || *iu != to_index(u) || iv == component.end() || *iv != to_index(v)) return;
    const Eigen::Index i = iu - component.begin(), k = iv - component.begin();
    laplacian(i, k) -= 1;
    laplacian(k, i) -= 1;
    laplacian(i, i) += 1;
    laplacian(k, k) += 1;
  };
  for (const Edge& e : input.inner_edges) link(e.u, e.v);
  for (const RecordedEdge& e : edges) link(e.u, e.v);
  return std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(laplacian).eigenvalues()(1));
}

// Kuhn's augmenting paths.
std::uint32_t matching(std::span<const RecordedEdge> edges, std::uint32_t n) {
  std::vector<std::vector<std::uint32_t>> targets(n);
  for (const RecordedEdge& e : edges) targets[to_index(e.u)].push_back(to_index(e.v));
  std::vector<std::uint32_t> partner(n, n);
  std::uint32_t size = 0;
  for (std::uint32_t u = 0; u < n; ++u) {
    std::vector<bool> tried(n, false);
    const std::function<bool(std::uint32_t)> augment = [&](std::uint32_t from) {
      for (const std::uint32_t v : targets[from]) {
        if (tried[v]) continue;
        tried[v] = true;
        if (partner[v] == n || augment(partner[v])) {
          partner[v] = from;
          return true;
        }
      }
      return false;
    };
    size += augment(u) ? 1 : 0;
  }
  return size;
}

TEST(Curves, AgreeWithDenseEigenvaluesAfterEveryEdge) {
  int partly_connected = 0, with_levels = 0;
  for (std::uint32_t seed = 0; seed < 28; ++seed) {
    MergeInput input = make_toy_merge(toy_world(seed));
    const RecordedRun run = record_run(input);
    const FinalComponent component(input, run.edges);
    const std::vector<std::uint32_t> expected = largest_component(input, run.edges);
    ASSERT_EQ(component.vertices(), expected.size()) << seed;

    RunCurve curve(component, run);
    std::vector<double> dense;
    for (std::size_t k = 0; k <= run.edges.size(); ++k) {
      const std::span<const RecordedEdge> taken(run.edges.data(), k);
      dense.push_back(dense_connectivity(input, expected, taken));
      const CurvePoint& point = curve.at(k);
      ASSERT_NEAR(point.connectivity, dense.back(), 1e-9) << seed << ", " << k << " edges";
      EXPECT_EQ(point.independent_joins, matching(taken, vertices_of(input))) << seed;
      std::set<VertexId> joined;
      for (const RecordedEdge& e : taken) joined.insert({e.u, e.v});
      EXPECT_EQ(point.joined_vertices, joined.size()) << seed;
    }
    ASSERT_NEAR(component.final_connectivity(), dense.back(), 1e-9);
    partly_connected += dense.front() < 1e-12 && dense.back() > 1e-6 ? 1 : 0;
    for (const double level : {0.5, 0.9, 0.95, 0.99, 1.0}) {
      // One that knows nothing yet has to search; one that knows every value must say the same.
      const auto reached = RunCurve(component, run).edges_to(level);
      ASSERT_TRUE(reached.has_value()) << seed;
      EXPECT_EQ(curve.edges_to(level), reached);
      const auto first =
          std::ranges::find_if(dense, [&](double value) { return value >= level * dense.back() * (1 - 1e-8) - 1e-12; });
      EXPECT_EQ(*reached, static_cast<std::uint64_t>(first - dense.begin())) << seed << ", level " << level;
      with_levels += *reached > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(partly_connected, 5) << "the worlds should show components that come together late";
  EXPECT_GT(with_levels, 20);
}

TEST(Curves, SayWhenARunStaysBelow) {
  const MergeInput input = make_toy_merge(toy_world(3));
  const RecordedRun whole = record_run(input);
  ASSERT_GT(whole.edges.size(), 3u);
  const FinalComponent component(input, whole.edges);
  RecordedRun cut = whole;
  cut.edges.resize(RunCurve(component, whole).edges_to(0.9).value() - 1);
  RunCurve curve(component, cut);
  EXPECT_EQ(curve.edges_to(0.9), std::nullopt);
  EXPECT_LT(curve.at(cut.edges.size()).connectivity, 0.9 * component.final_connectivity());
}

TEST(Curves, PointsRunFromNothingToAllAndAscend) {
  MergeInput input = make_toy_merge(toy_world(5));
  const RecordedRun run = record_run(input);
  const FinalComponent component(input, run.edges);
  const std::vector<CurvePoint> points = RunCurve(component, run).points(8);
  ASSERT_GE(points.size(), 2u);
  EXPECT_EQ(points.front().edges, 0u);
  EXPECT_EQ(points.back().edges, run.edges.size());
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_LT(points[i - 1].edges, points[i].edges);
    EXPECT_LE(points[i - 1].connectivity, points[i].connectivity * (1 + 1e-9) + 1e-12) << "lambda_2 only grows";
  }
}

TEST(Costs, AreWhatTheAxisSays) {
  const Cost cost{.verifications = 100, .elapsed_s = 1.5, .verifier_s = 1.2};
  EXPECT_DOUBLE_EQ(on_axis(cost, CostAxis::kVerifications, 0.02), 100);
  EXPECT_DOUBLE_EQ(on_axis(cost, CostAxis::kTime, 0.02), 1.5);
  EXPECT_DOUBLE_EQ(on_axis(cost, CostAxis::kModelledTime, 0.02), 0.3 + 2.0);

  RecordedRun run;
  for (const std::uint64_t verifications : {3u, 5u, 5u, 9u}) {
    run.edges.push_back(
        {VertexId{0},
         VertexId{1},
         1,
         1,
         {.verifications = verifications, .elapsed_s = 0.1 * static_cast<double>(verifications), .verifier_s = 0}});
  }
  const auto within = [&](double budget) { return edges_within(run, CostAxis::kVerifications, 0, budget); };
  EXPECT_EQ(within(2), 0u);
  EXPECT_EQ(within(3), 1u);
  EXPECT_EQ(within(5), 3u);
  EXPECT_EQ(within(8.9), 3u);
  EXPECT_EQ(within(1000), 4u);
  EXPECT_EQ(edges_within(run, CostAxis::kTime, 0, 0.5001), 3u);
  EXPECT_EQ(cost_of(run, 0).verifications, 0u);
  EXPECT_EQ(cost_of(run, 4).verifications, 9u);
}

TEST(RecordedRun, IsTheMergeThatTheMergerMakes) {
  for (std::uint32_t seed = 0; seed < 14; ++seed) {
    MergeInput input = make_toy_merge(toy_world(seed));
    const auto merger = make_merger(input);
    while (!merger->done()) merger->step();
    std::uint64_t told = 0;
    const RecordedRun run = record_run(input, [&](std::uint64_t verifications) { told = verifications; });
    const MergeState& state = merger->state();
    ASSERT_EQ(run.edges.size(), state.edges.size());
    EXPECT_EQ(run.cost.verifications, state.verifications);
    EXPECT_EQ(told, state.verifications);
    Cost before;
    for (std::size_t i = 0; i < run.edges.size(); ++i) {
      EXPECT_EQ(run.edges[i].u, state.edges[i].u);
      EXPECT_EQ(run.edges[i].v, state.edges[i].v);
      EXPECT_EQ(run.edges[i].inliers, static_cast<std::uint32_t>(state.edges[i].verification.inliers));
      EXPECT_EQ(run.edges[i].votes, state.edges[i].votes);
      EXPECT_EQ(run.edges[i].cost.verifications, state.edges[i].verifications);
      EXPECT_GE(run.edges[i].cost.elapsed_s, before.elapsed_s);
      EXPECT_GE(run.edges[i].cost.verifier_s, before.verifier_s);
      before = run.edges[i].cost;
    }
    EXPECT_GE(run.cost.elapsed_s, run.cost.verifier_s);
  }
}

}  // namespace
}  // namespace mapweld::server::evaluation
