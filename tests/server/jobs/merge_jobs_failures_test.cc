// Jobs that cannot go on: a verifier, a checkpoint, a disk that fails, a row that is gone.
#include <algorithm>

#include <gtest/gtest.h>

#include "schema/engine/store_error.h"
#include "schema/maps/edge_store.h"
#include "schema/merges/merge_store.h"
#include "tests/server/jobs/jobs_fixture.h"

namespace mapweld::server {
namespace {

using MergeJobsFailures = JobsOnToyMaps;

TEST_F(MergeJobsFailures, AJobDeletedBehindItsBackIsFencedOff) {
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

TEST_F(MergeJobsFailures, AFailureIsToldAndCanBeResumed) {
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

TEST_F(MergeJobsFailures, ADamagedCheckpointFailsTheJobWithItsReason) {
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

TEST_F(MergeJobsFailures, AnotherVerifierDoesNotGoOnWithOldVerdicts) {
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

TEST_F(MergeJobsFailures, AFullDiskIsWaitedForAndRoomLetsTheMergeGoOn) {
  const std::int64_t id = submit(verifications(20));
  wait(id);
  const auto limit_to = [&](std::int64_t more_pages) {
    const std::int64_t pages = store_.read().connection().query_integer("PRAGMA page_count");
    store_.store().limit_pages(static_cast<std::uint32_t>(pages + more_pages));
  };
  limit_to(2);
  jobs_->resume(id, std::nullopt);
  while (jobs_->get(id).stop_reason != "no_space") {
    ASSERT_NE(jobs_->get(id).state, JobState::kFailed);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const double elapsed_s = jobs_->get(id).elapsed_s;
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  EXPECT_EQ(jobs_->get(id).stop_reason, "no_space") << "it does not give up";
  EXPECT_EQ(jobs_->get(id).elapsed_s, elapsed_s);
  limit_to(100'000);
  const MergeStatus s = wait(id);
  EXPECT_EQ(s.state, JobState::kCompleted);
  EXPECT_EQ(s.stop_reason, std::nullopt);
  expect_uninterrupted(id);
}

TEST_F(MergeJobsFailures, AServerThatStopsOnAFullDiskLeavesTheMergeForLater) {
  const std::int64_t id = submit(verifications(20));
  wait(id);
  store_.store().limit_pages(
      static_cast<std::uint32_t>(store_.read().connection().query_integer("PRAGMA page_count") + 2));
  jobs_->resume(id, std::nullopt);
  while (jobs_->get(id).stop_reason != "no_space") std::this_thread::sleep_for(std::chrono::milliseconds(2));
  jobs_.reset();
  store_.store().limit_pages(1u << 30);
  open();
  EXPECT_EQ(wait(id).state, JobState::kCompleted);
  expect_uninterrupted(id);
}

}  // namespace
}  // namespace mapweld::server
