#include "server/evaluation/evaluation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/merge/toy_maps.h"

namespace mapweld::server::evaluation {
namespace {

using test::make_toy_merge;
using test::toy_world;

class CountingVerifier final : public PairVerifier {
 public:
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    ++calls;
    return verdicts_.verify(a, b);
  }
  std::string version() const override { return verdicts_.version(); }
  const VerifierOptions& options() const override { return verdicts_.options(); }
  mutable std::atomic<std::uint64_t> calls = 0;

 private:
  test::HashVerifier verdicts_{0.5};
};

TEST(Summary, IsMeanAndSampleDeviation) {
  EXPECT_EQ(summary_of({}), (Summary{0, 0, 0}));
  EXPECT_EQ(summary_of(std::vector{7.0}), (Summary{1, 7, 0}));
  const Summary summary = summary_of(std::vector{2.0, 4.0, 4.0, 6.0});
  EXPECT_EQ(summary.count, 4u);
  EXPECT_DOUBLE_EQ(summary.mean, 4);
  EXPECT_DOUBLE_EQ(summary.deviation, std::sqrt(8.0 / 3));
}

TEST(Evaluation, MeasuresEveryMethodAgainstOneFinalValue) {
  for (std::uint32_t seed = 0; seed < 7; ++seed) {
    EvaluationOptions options;
    options.runs = 3;
    options.seed = 40;
    const Evaluation evaluation = evaluate(make_toy_merge(toy_world(seed)), options);
    EXPECT_EQ(evaluation.methods.size(), merge_methods().size());
    for (const MethodResult& method : evaluation.methods) {
      ASSERT_EQ(method.runs.size(), is_randomised(method.method) ? 3u : 1u) << method.method;
      if (method.method == "alignment") {  // leaves candidates out
        EXPECT_LE(method.runs[0].cost.verifications, evaluation.candidates);
        EXPECT_EQ(method.is_complete, method.runs[0].edges.size() == evaluation.all_edges.size());
        continue;
      }
      EXPECT_TRUE(method.is_complete) << method.method;
      for (std::size_t i = 0; i < method.runs.size(); ++i) {
        EXPECT_EQ(method.runs[i].seed, 40 + i);
        EXPECT_EQ(method.runs[i].cost.verifications, evaluation.candidates) << method.method;
        EXPECT_NEAR(method.curves[i].back().connectivity, evaluation.final_connectivity,
                    1e-9 * evaluation.final_connectivity);
        EXPECT_EQ(method.curves[i].back().joined_vertices, evaluation.finished.joined_vertices);
        EXPECT_EQ(method.curves[i].back().independent_joins, evaluation.finished.independent_joins);
      }
      double before = 0;
      for (const LevelCost& cost : method.levels) {
        EXPECT_EQ(cost.reached, method.runs.size());
        EXPECT_LE(before, cost.verifications.mean) << "a higher level takes no fewer verifications";
        EXPECT_LE(cost.edges.mean, cost.verifications.mean);
        before = cost.verifications.mean;
      }
    }
  }
}

TEST(Evaluation, SummarisesTheRunsOfEachMethod) {
  const MergeInput input = make_toy_merge(toy_world(2));
  EvaluationOptions options;
  options.levels = {0.9};
  const Evaluation evaluation = evaluate(input, options);
  for (const MethodResult& method : evaluation.methods) {
    std::vector<double> verifications;
    const FinalComponent component(input, evaluation.all_edges);
    for (const RecordedRun& run : method.runs) {
      const auto reached = RunCurve(component, run).edges_to(0.9);
      if (reached) verifications.push_back(static_cast<double>(cost_of(run, *reached).verifications));
    }
    EXPECT_EQ(method.levels[0].verifications, summary_of(verifications)) << method.method;
  }
}

TEST(Evaluation, ComparesAtAShareOfTheBaseline) {
  const MergeInput input = make_toy_merge(toy_world(5));
  EvaluationOptions options;
  options.methods = {"quickconnect"};
  options.share_of_baseline = 0.25;
  const Evaluation evaluation = evaluate(input, options);
  ASSERT_EQ(evaluation.methods.size(), 2u) << "the baseline is added";
  EXPECT_EQ(evaluation.methods[1].method, kBaseline);
  const MethodResult& quick = evaluation.methods[0];
  const auto quality = std::ranges::find(quick.at_share, CostAxis::kVerifications, &QualityAtShare::axis);
  ASSERT_NE(quality, quick.at_share.end());
  EXPECT_DOUBLE_EQ(quality->budget, 0.25 * static_cast<double>(evaluation.candidates));
  const auto taken = std::ranges::count_if(quick.runs[0].edges, [&](const RecordedEdge& e) {
    return static_cast<double>(e.cost.verifications) <= quality->budget;
  });
  const FinalComponent component(input, evaluation.all_edges);
  const double expected =
      component.connectivity(std::span(quick.runs[0].edges.data(), static_cast<std::size_t>(taken)));
  EXPECT_NEAR(quality->connectivity.mean, expected / evaluation.final_connectivity, 1e-12);
}

// Passes as HashVerifier does, with matches that the images have.
class MatchingVerifier final : public PairVerifier {
 public:
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    Verification verdict = verdicts_.verify(a, b);
    verdict.inlier_matches.clear();
    const std::size_t features = std::min(a.appearances.size(), b.appearances.size());
    for (std::uint16_t i = 0; verdict.accepted && i < features; ++i) verdict.inlier_matches.emplace_back(i, i);
    return verdict;
  }
  std::string version() const override { return verdicts_.version(); }
  const VerifierOptions& options() const override { return verdicts_.options(); }

 private:
  test::HashVerifier verdicts_{0.5};
};

// The inner edges of a toy world, of features that both images have.
std::vector<VerifiedEdge> matched_inner_edges(const MergeInput& input) {
  std::vector<VerifiedEdge> edges;
  for (const Edge& e : input.inner_edges) {
    VerifiedEdge& edge = edges.emplace_back();
    edge.u = e.u, edge.v = e.v;
    const std::size_t features = std::min(input.appearances->appearances(e.u)->appearances.size(),
                                          input.appearances->appearances(e.v)->appearances.size());
    for (std::uint16_t i = 0; i < features; ++i) edge.inlier_matches.emplace_back(i, i);
  }
  return edges;
}

TEST(Evaluation, CountsOnlyConfirmedEdgesOnRequest) {
  int withheld = 0, confirmed = 0;
  for (std::uint32_t seed = 0; seed < 7; ++seed) {
    MergeInput input = make_toy_merge(toy_world(seed));
    input.verifier = std::make_shared<const MatchingVerifier>();
    EvaluationOptions options;
    options.methods = {"quickconnect"};
    options.guard = true;
    options.inner_edges = matched_inner_edges(input);
    // The guard believes in nothing here: it is made to confirm the better half.
    std::vector<double> confidences;
    for (const RecordedEdge& edge : evaluate(input, options).all_edges) confidences.push_back(edge.confidence.value());
    if (confidences.empty()) continue;
    std::ranges::sort(confidences);
    options.min_confidence = confidences[confidences.size() / 2];
    const Evaluation all = evaluate(input, options);
    options.confirmed = true;
    const Evaluation counted = evaluate(input, options);
    ASSERT_EQ(counted.all_edges.size(), all.all_edges.size()) << "what passes is told either way";
    EXPECT_EQ(counted.counted_edges().size(), *all.confirmed_edges);
    EXPECT_EQ(counted.finished.edges, *all.confirmed_edges);
    const FinalComponent component(input, counted.counted_edges());
    EXPECT_EQ(counted.final_connectivity, component.final_connectivity());
    for (std::size_t m = 0; m < counted.methods.size(); ++m) {
      const RecordedRun &some = counted.methods[m].runs[0], &whole = all.methods[m].runs[0];
      EXPECT_EQ(some.edges.size(), *all.confirmed_edges);
      EXPECT_TRUE(counted.methods[m].is_complete);
      EXPECT_EQ(some.cost.verifications, whole.cost.verifications) << "the others are paid for all the same";
      for (const RecordedEdge& edge : some.edges) {
        const auto same = [&](const RecordedEdge& e) { return e.u == edge.u && e.v == edge.v; };
        const auto judged = std::ranges::find_if(all.all_edges, same), paid = std::ranges::find_if(whole.edges, same);
        ASSERT_TRUE(judged != all.all_edges.end() && paid != whole.edges.end());
        EXPECT_TRUE(judged->confirmed);
        EXPECT_EQ(edge.cost.verifications, paid->cost.verifications);
      }
    }
    confirmed += static_cast<int>(*all.confirmed_edges);
    withheld += static_cast<int>(all.all_edges.size() - *all.confirmed_edges);
  }
  EXPECT_GT(withheld, 0);
  EXPECT_GT(confirmed, 0);
  EvaluationOptions unjudged;
  unjudged.confirmed = true;
  EXPECT_THROW(evaluate(make_toy_merge(toy_world(1)), unjudged), std::invalid_argument);
}

TEST(Evaluation, RefusesAMethodThatThereIsNot) {
  EvaluationOptions options;
  options.methods = {"by-magic"};
  EXPECT_THROW(evaluate(make_toy_merge(toy_world(1)), options), std::invalid_argument);
}

TEST(Evaluation, SharesVerdictsOnlyThroughAMemo) {
  MergeInput input = make_toy_merge(toy_world(5));
  EvaluationOptions options;
  options.methods = {"quickconnect", "brute-force"};
  const auto counting = std::make_shared<const CountingVerifier>();
  input.verifier = counting;
  const Evaluation apart = evaluate(input, options);
  ASSERT_GT(apart.candidates, 0u);
  EXPECT_EQ(counting->calls, 2 * apart.candidates);

  counting->calls = 0;
  input.verifier = std::make_shared<MemoVerifier>(counting);
  const Evaluation shared = evaluate(input, options);
  EXPECT_EQ(counting->calls, shared.candidates);
  EXPECT_EQ(shared.final_connectivity, apart.final_connectivity);
  for (std::size_t m = 0; m < 2; ++m) {
    for (std::size_t l = 0; l < options.levels.size(); ++l) {
      EXPECT_EQ(shared.methods[m].levels[l].verifications, apart.methods[m].levels[l].verifications);
    }
  }
}

TEST(Evaluation, TellsHowFarItIs) {
  std::vector<EvaluationProgress> told;
  EvaluationOptions options;
  options.methods = {"quickconnect"};
  const Evaluation evaluation =
      evaluate(make_toy_merge(toy_world(5)), options, [&](const EvaluationProgress& p) { told.push_back(p); });
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(std::ranges::any_of(told, [](const EvaluationProgress& p) { return p.stage == "limit"; }));
  EXPECT_EQ(told.front().stage, "quickconnect");
  EXPECT_EQ(told.front().total, evaluation.candidates);
  EXPECT_EQ(told.back().stage, "eigenvalues");
  EXPECT_EQ(told.back().done, told.back().total);
}

}  // namespace
}  // namespace mapweld::server::evaluation
