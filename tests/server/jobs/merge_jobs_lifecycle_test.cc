// Stopping a job and going on: budgets, pause, resume, cancel, delete, restart, failure.
#include <algorithm>

#include <gtest/gtest.h>

#include "schema/map_store.h"
#include "server/jobs/merge_jobs.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

using test::ToyWorld;
constexpr std::chrono::seconds kLong{60};

class MergeJobsLifecycle : public ::testing::Test {
 protected:
  void SetUp() override {
    test::store_toy_maps(store_, world_);
    open();
  }
  void open() {
    MergeJobOptions options = test::job_options(verifier_);
    options.checkpoint_interval_s = 0.01;
    jobs_ = std::make_unique<MergeJobs>(store_, options);
    jobs_->start();
  }
  std::int64_t submit(const MergeBudget& budget = {}, const std::string& name = "ab") {
    MergeRequest request = test::request_of(world_, name);
    request.budget = budget;
    return jobs_->submit(request).id;
  }
  MergeStatus wait(std::int64_t id) { return jobs_->wait(id, kLong); }
  // Waits until a running job has made some verifications.
  void meet(std::int64_t id, std::uint64_t verifications) {
    for (;;) {
      const MergeStatus s = jobs_->get(id);
      if (s.state != JobState::kQueued && (s.state != JobState::kRunning || s.candidates.verified >= verifications)) {
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  void expect_uninterrupted(std::int64_t id) { EXPECT_EQ(test::stored_state(store_, id), test::uninterrupted(world_)); }
  template <typename Call>
  void expect_code(const std::string& code, const Call& call) {
    try {
      call();
      ADD_FAILURE() << "not refused: " << code;
    } catch (const MergeJobError& error) {
      EXPECT_EQ(error.code(), code) << error.what();
    }
  }
  static MergeBudget seconds(double n) {
    MergeBudget budget;
    budget.seconds = n;
    return budget;
  }
  static MergeBudget verifications(std::uint64_t n) {
    MergeBudget budget;
    budget.verifications = n;
    return budget;
  }
  static MergeBudget edges(std::uint64_t n) {
    MergeBudget budget;
    budget.edges = n;
    return budget;
  }

  ToyWorld world_ = test::toy_world(19);
  std::shared_ptr<test::SlowVerifier> verifier_ =
      std::make_shared<test::SlowVerifier>(world_.accept_share, std::chrono::microseconds(500));
  test::TempStore store_;
  std::unique_ptr<MergeJobs> jobs_;
};

TEST_F(MergeJobsLifecycle, ABudgetOfVerificationsIsKeptToTheNumber) {
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

TEST_F(MergeJobsLifecycle, ABudgetOfEdgesStopsAtTheEdge) {
  const std::int64_t id = submit(edges(9));
  const MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kBudgetExhausted);
  EXPECT_EQ(s.stop_reason, "edges");
  EXPECT_EQ(s.edges, 9u);
  EXPECT_EQ(jobs_->edges(id, 100, std::nullopt).items.size(), 9u);
}

TEST_F(MergeJobsLifecycle, ABudgetOfSecondsStopsAroundThem) {
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

TEST_F(MergeJobsLifecycle, OfSeveralLimitsTheFirstStops) {
  MergeBudget budget = verifications(12);
  budget.seconds = 3600;
  budget.edges = 100000;
  const MergeStatus s = wait(submit(budget));
  EXPECT_EQ(s.stop_reason, "verifications");
  EXPECT_EQ(s.candidates.verified, 12u);
}

TEST_F(MergeJobsLifecycle, PausingOftenChangesNothing) {
  const std::int64_t id = submit();
  int pauses = 0;
  for (std::uint64_t n = 5; pauses < 12; n += 25) {
    meet(id, n);
    if (jobs_->get(id).state == JobState::kCompleted) break;
    MergeStatus s;
    try {
      s = jobs_->pause(id);
    } catch (const MergeJobError&) {
      break;  // it was quicker
    }
    EXPECT_EQ(s.state, JobState::kPaused);
    EXPECT_EQ(s.stop_reason, "paused");
    const std::uint64_t calls = verifier_->calls;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    EXPECT_EQ(verifier_->calls, calls);  // it rests
    ASSERT_TRUE(s.checkpoint);
    EXPECT_EQ(s.checkpoint->step, s.step);
    EXPECT_EQ(jobs_->edges(id, 1000, std::nullopt).items.size(), s.edges);
    ++pauses;
    jobs_->resume(id, std::nullopt);
  }
  EXPECT_GE(pauses, 5);
  EXPECT_EQ(wait(id).state, JobState::kCompleted);
  expect_uninterrupted(id);
}

// A job that stops for its fraction exactly where a budget of verifications stops it, too.
TEST_F(MergeJobsLifecycle, AFractionIsReachedWhereItIsReachedWithoutInterruption) {
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

TEST_F(MergeJobsLifecycle, APausedJobKeepsTheRemainderOfItsBudget) {
  const std::int64_t id = submit(verifications(60));
  meet(id, 10);
  const MergeStatus paused = jobs_->pause(id);
  EXPECT_EQ(*paused.remaining.verifications, 60 - paused.candidates.verified);
  jobs_->resume(id, std::nullopt);
  const MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kBudgetExhausted);
  EXPECT_EQ(s.candidates.verified, 60u);
}

TEST_F(MergeJobsLifecycle, AQueuedJobCanBePausedAndCancelled) {
  const std::int64_t first = submit();
  const std::int64_t second = submit({}, "second"), third = submit({}, "third");
  EXPECT_EQ(jobs_->get(second).state, JobState::kQueued);
  EXPECT_EQ(jobs_->pause(second).state, JobState::kPaused);
  EXPECT_EQ(jobs_->cancel(third).state, JobState::kCancelled);
  EXPECT_EQ(wait(first).state, JobState::kCompleted);
  EXPECT_EQ(jobs_->get(second).state, JobState::kPaused);
  jobs_->resume(second, std::nullopt);
  EXPECT_EQ(wait(second).state, JobState::kCompleted);
  expect_uninterrupted(second);
  EXPECT_EQ(jobs_->get(third).candidates.verified, 0u);
}

TEST_F(MergeJobsLifecycle, CancellingIsFinalAndKeepsTheEdges) {
  const std::int64_t id = submit();
  meet(id, 40);
  const MergeStatus s = jobs_->cancel(id);
  EXPECT_EQ(s.state, JobState::kCancelled);
  EXPECT_EQ(s.stop_reason, std::nullopt);
  EXPECT_GT(s.edges, 0u);
  EXPECT_EQ(jobs_->edges(id, 1000, std::nullopt).items.size(), s.edges);
  expect_code("wrong_state", [&] { jobs_->resume(id, std::nullopt); });
  expect_code("wrong_state", [&] { jobs_->pause(id); });
  expect_code("wrong_state", [&] { jobs_->cancel(id); });
  EXPECT_EQ(jobs_->get(id).edges, s.edges);
}

TEST_F(MergeJobsLifecycle, StatesAllowOnlyWhatTheyShould) {
  const std::int64_t id = submit(verifications(3));
  wait(id);
  expect_code("wrong_state", [&] { jobs_->pause(id); });
  jobs_->resume(id, std::nullopt);
  meet(id, 10);
  expect_code("wrong_state", [&] { jobs_->resume(id, std::nullopt); });
  wait(id);
  expect_code("nothing_to_resume", [&] { jobs_->resume(id, std::nullopt); });
  expect_code("wrong_state", [&] { jobs_->pause(id); });
  expect_code("wrong_state", [&] { jobs_->cancel(id); });
  expect_code("invalid_budget", [&] { jobs_->resume(id, verifications(0)); });
  for (const std::int64_t unknown : {99, 0, -1}) {
    expect_code("no_such_merge", [&] { jobs_->get(unknown); });
    expect_code("no_such_merge", [&] { jobs_->pause(unknown); });
    expect_code("no_such_merge", [&] { jobs_->resume(unknown, std::nullopt); });
    expect_code("no_such_merge", [&] { jobs_->cancel(unknown); });
    expect_code("no_such_merge", [&] { jobs_->remove(unknown); });
    expect_code("no_such_merge", [&] { jobs_->curve(unknown, 10, std::nullopt); });
    expect_code("no_such_merge", [&] { jobs_->edges(unknown, 10, std::nullopt); });
  }
  expect_code("invalid_parameter", [&] { jobs_->edges(id, 10, "x"); });
}

TEST_F(MergeJobsLifecycle, DeletingARunningJobTakesEverythingWithIt) {
  const std::int64_t id = submit();
  meet(id, 30);
  jobs_->remove(id);
  const std::uint64_t calls = verifier_->calls;
  expect_code("no_such_merge", [&] { jobs_->get(id); });
  EXPECT_TRUE(jobs_->list(std::nullopt, 10, std::nullopt).items.empty());
  {
    const ReadTransaction db = store_.read();
    EXPECT_FALSE(find_map(db, "ab"));
    EXPECT_TRUE(load_checkpoint(db, JobId{id}).empty());
    EXPECT_TRUE(list_curve(db, JobId{id}, 10).empty());
    EXPECT_TRUE(list_merge_edges(db, JobId{id}, 10).empty());
    EXPECT_TRUE(find_map(db, "a"));
    EXPECT_TRUE(find_map(db, "b"));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(verifier_->calls, calls);  // its worker has stopped
  const std::int64_t again = submit();
  EXPECT_GT(again, id);  // numbers do not come back
  EXPECT_EQ(wait(again).state, JobState::kCompleted);
  expect_uninterrupted(again);
}

TEST_F(MergeJobsLifecycle, AJobDeletedBehindItsBackIsFencedOff) {
  const std::int64_t id = submit();
  meet(id, 30);
  {
    WriteTransaction db = store_.write();
    EXPECT_EQ(delete_merge(db, JobId{id}), DeleteOutcome::kDeleted);
    db.commit();
  }
  const std::int64_t next = submit({}, "next");
  EXPECT_EQ(wait(next).state, JobState::kCompleted);
  expect_uninterrupted(next);
  expect_code("no_such_merge", [&] { jobs_->get(id); });
  EXPECT_TRUE(list_merge_edges(store_.read(), JobId{id}, 10).empty());
}

TEST_F(MergeJobsLifecycle, AMergeInUseIsNotDeleted) {
  const std::int64_t ab = submit(verifications(40));
  wait(ab);
  test::ToyWorld third = world_;
  test::store_toy_maps(store_, third, "c", "d");
  MergeRequest request = test::request_of(world_, "abc");
  request.maps = {"ab", "c"};
  const std::int64_t abc = jobs_->submit(request).id;
  jobs_->resume(ab, std::nullopt);
  expect_code("map_in_use", [&] { jobs_->remove(ab); });
  EXPECT_EQ(wait(ab).state, JobState::kCompleted);  // and it was not disturbed
  EXPECT_EQ(wait(abc).state, JobState::kCompleted);
  jobs_->remove(abc);
  jobs_->remove(ab);
  EXPECT_FALSE(find_map(store_.read(), "ab"));
}

TEST_F(MergeJobsLifecycle, ARestartGoesOnByItselfAndRenewsNothing) {
  const std::int64_t running = submit(verifications(80));
  const std::int64_t queued = submit({}, "queued");
  const std::int64_t paused = submit({}, "paused");
  jobs_->pause(paused);
  double elapsed_s = 0;
  for (int restart = 0; restart < 3; ++restart) {
    meet(running, 10 + 20 * static_cast<std::uint64_t>(restart));
    jobs_.reset();  // checkpoints and stops
    store_.reopen();
    const auto row = find_merge(store_.read(), JobId{running});
    EXPECT_EQ(row->state, JobState::kRunning);
    EXPECT_GT(row->spent.elapsed_s, elapsed_s);
    elapsed_s = row->spent.elapsed_s;
    EXPECT_EQ(row->spent.verifications, test::stored_state(store_, running).verifications);
    open();
  }
  const MergeStatus s = wait(running);
  EXPECT_EQ(s.state, JobState::kBudgetExhausted);
  EXPECT_EQ(s.candidates.verified, 80u);
  EXPECT_EQ(wait(queued).state, JobState::kCompleted);
  expect_uninterrupted(queued);
  EXPECT_EQ(jobs_->get(paused).state, JobState::kPaused);
  // What was shut down in order is not done twice.
  EXPECT_EQ(verifier_->calls, 80 + test::uninterrupted(world_).verifications);
}

TEST_F(MergeJobsLifecycle, AFailureIsToldAndCanBeResumed) {
  const std::int64_t id = submit(verifications(1000000));
  meet(id, 30);
  verifier_->fails = true;
  MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kFailed);
  EXPECT_EQ(s.stop_reason, "error");
  EXPECT_NE(s.error.value_or("").find("out of order"), std::string::npos);
  verifier_->fails = false;
  s = jobs_->resume(id, std::nullopt);
  EXPECT_EQ(s.error, std::nullopt);
  EXPECT_EQ(s.budget, MergeBudget{});
  EXPECT_EQ(wait(id).state, JobState::kCompleted);
  expect_uninterrupted(id);
}

TEST_F(MergeJobsLifecycle, ADamagedCheckpointFailsTheJobWithItsReason) {
  const std::int64_t id = submit(verifications(30));
  wait(id);
  {
    WriteTransaction db = store_.write();
    db.prepare("UPDATE checkpoints SET bytes = zeroblob(length(bytes)) WHERE job = ? AND part = 'similarity'")
        .bind(1, id)
        .run();
    db.commit();
  }
  jobs_->resume(id, std::nullopt);
  const MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kFailed);
  EXPECT_NE(s.error.value_or("").find("similarity"), std::string::npos);
  EXPECT_EQ(jobs_->edges(id, 1000, std::nullopt).items.size(), s.edges);  // what it had stays
}

TEST_F(MergeJobsLifecycle, AnotherVerifierDoesNotGoOnWithOldVerdicts) {
  const std::int64_t id = submit(verifications(30));
  wait(id);
  jobs_.reset();
  MergeJobOptions options = test::job_options(verifier_);
  options.verifier = [](const VerifierOptions&) {
    return std::make_shared<test::HashVerifier>(0.5, VerifierOptions{40, 1e-9});
  };
  jobs_ = std::make_unique<MergeJobs>(store_, options);
  jobs_->start();
  jobs_->resume(id, std::nullopt);
  const MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kFailed);
  EXPECT_NE(s.error.value_or("").find("verifier"), std::string::npos);
}

TEST_F(MergeJobsLifecycle, AFullDiskFailsTheJobAndRoomLetsItGoOn) {
  const std::int64_t id = submit(verifications(20));
  wait(id);
  std::int64_t pages = 0;
  {
    const ReadTransaction db = store_.read();
    sqlite::Statement row = db.prepare("PRAGMA page_count");
    row.step();
    pages = row.integer(0);
  }
  store_.store().limit_pages(static_cast<std::uint32_t>(pages));
  MergeStatus s;
  try {
    jobs_->resume(id, std::nullopt);
    s = wait(id);
    EXPECT_EQ(s.state, JobState::kFailed);
    EXPECT_TRUE(s.error);
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kNoSpace);
  }
  store_.store().limit_pages(1u << 30);
  jobs_->resume(id, std::nullopt);
  EXPECT_EQ(wait(id).state, JobState::kCompleted);
  expect_uninterrupted(id);
}

}  // namespace
}  // namespace mapweld::server
