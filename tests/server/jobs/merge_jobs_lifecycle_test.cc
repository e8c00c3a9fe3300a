// Stopping a job and going on: pause, resume, cancel, delete, a server that restarts.
#include <algorithm>

#include <gtest/gtest.h>

#include "schema/maps/map_store.h"
#include "schema/merges/merge_store.h"
#include "tests/server/jobs/jobs_fixture.h"

namespace mapweld::server {
namespace {

using MergeJobsLifecycle = JobsOnToyMaps;

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
  std::uint64_t verified = 0;
  for (int restart = 0; restart < 3; ++restart) {
    meet(running, verified + 1);
    jobs_.reset();  // checkpoints and stops
    store_.reopen();
    const auto row = find_merge(store_.read(), JobId{running});
    EXPECT_EQ(row->state, JobState::kRunning);
    EXPECT_GT(row->spent.elapsed_s, elapsed_s);
    EXPECT_GT(row->spent.verifications, verified);
    elapsed_s = row->spent.elapsed_s;
    verified = row->spent.verifications;
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

}  // namespace
}  // namespace mapweld::server
