// What a job may spend: it stops there, and what is left of a budget stays.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/server/jobs/jobs_fixture.h"

namespace mapweld::server {
namespace {

using MergeJobsBudgets = JobsOnToyMaps;

TEST_F(MergeJobsBudgets, ABudgetOfVerificationsIsKeptToTheNumber) {
  const std::int64_t id = submit(verifications(17));
  MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kBudgetExhausted);
  EXPECT_EQ(s.stop_reason, "verifications");
  EXPECT_EQ(s.candidates.verified, 17u);
  EXPECT_EQ(verifier_->calls, 17u);
  EXPECT_EQ(s.budget.verifications, 17u);
  EXPECT_EQ(s.remaining.verifications, 0u);

  s = jobs_->resume(id, verifications(5));  // on top of what was spent
  s = wait(id);
  EXPECT_EQ(s.stop_reason, "verifications");
  EXPECT_EQ(s.candidates.verified, 22u);

  s = jobs_->resume(id, std::nullopt);  // without a budget: to the end
  EXPECT_EQ(s.budget, MergeBudget{});
  s = wait(id);
  EXPECT_EQ(s.state, JobState::kCompleted);
  expect_uninterrupted(id);
  EXPECT_EQ(verifier_->calls, test::uninterrupted(world_).verifications);  // nothing was done twice
}

TEST_F(MergeJobsBudgets, ABudgetOfEdgesStopsAtTheEdge) {
  const std::int64_t id = submit(edges(9));
  const MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kBudgetExhausted);
  EXPECT_EQ(s.stop_reason, "edges");
  EXPECT_EQ(s.edges, 9u);
  EXPECT_EQ(jobs_->edges(id, 100, std::nullopt).items.size(), 9u);
}

TEST_F(MergeJobsBudgets, ABudgetOfSecondsStopsAroundThem) {
  const std::int64_t id = submit(seconds(0.05));
  MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kBudgetExhausted);
  EXPECT_EQ(s.stop_reason, "seconds");
  EXPECT_GE(s.elapsed_s, 0.02);
  ASSERT_TRUE(s.remaining.seconds);
  EXPECT_LT(*s.remaining.seconds, 0.03);
  EXPECT_GT(s.candidates.verified, 0u);
  EXPECT_LT(s.candidates.verified, test::uninterrupted(world_).verifications);
  const double spent_s = s.elapsed_s;
  jobs_->resume(id, seconds(0.03));
  s = wait(id);
  EXPECT_EQ(s.stop_reason, "seconds");
  EXPECT_GE(s.elapsed_s, spent_s + 0.01);
  jobs_->resume(id, std::nullopt);
  EXPECT_EQ(wait(id).state, JobState::kCompleted);
  expect_uninterrupted(id);
}

TEST_F(MergeJobsBudgets, OfSeveralLimitsTheFirstStops) {
  MergeBudget budget = verifications(12);
  budget.seconds = 3600;
  budget.edges = 100000;
  const MergeStatus s = wait(submit(budget));
  EXPECT_EQ(s.stop_reason, "verifications");
  EXPECT_EQ(s.candidates.verified, 12u);
}

// A job that stops for its fraction exactly where a budget of verifications stops it, too.
TEST_F(MergeJobsBudgets, AFractionIsReachedWhereItIsReachedWithoutInterruption) {
  world_.sizes = {40, 30};
  world_.accept_share = 0.4;
  world_.seed = 3;
  test::store_toy_maps(store_, world_, "c", "d");
  verifier_ = std::make_shared<test::SlowVerifier>(world_.accept_share, std::chrono::microseconds(0));
  jobs_.reset();
  open();
  const auto run_job = [this](const MergeBudget& budget, const std::string& name) {
    MergeRequest request = test::request_of(world_, name);
    request.maps = {"c", "d"};
    request.budget = budget;
    return wait(jobs_->submit(request).id);
  };
  MergeBudget fraction;
  fraction.fraction_of_maximum = 0.5;
  const MergeStatus straight = run_job(fraction, "straight");
  ASSERT_EQ(straight.stop_reason, "fraction_of_maximum");
  const MergeStatus resumed_at = run_job(verifications(straight.candidates.verified), "stopped");
  ASSERT_EQ(resumed_at.stop_reason, "verifications");
  const std::uint64_t calls = verifier_->calls;
  for (const double lower : {0.5, 0.5, 0.1}) {
    fraction.fraction_of_maximum = lower;
    for (const std::int64_t id : {straight.id, resumed_at.id}) {
      jobs_->resume(id, fraction);
      EXPECT_EQ(wait(id).stop_reason, "fraction_of_maximum");
      EXPECT_EQ(test::stored_state(store_, id), test::stored_state(store_, straight.id));
    }
  }
  EXPECT_EQ(verifier_->calls, calls);
}

TEST_F(MergeJobsBudgets, APausedJobKeepsTheRemainderOfItsBudget) {
  const std::int64_t id = submit(verifications(60));
  meet(id, 10);
  const MergeStatus paused = jobs_->pause(id);
  EXPECT_EQ(*paused.remaining.verifications, 60 - paused.candidates.verified);
  jobs_->resume(id, std::nullopt);
  const MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kBudgetExhausted);
  EXPECT_EQ(s.candidates.verified, 60u);
}

}  // namespace
}  // namespace mapweld::server
