// Beginning a merge afresh: nothing of the old one is left, everything that names it stays, and it is all or nothing.
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/engine/data_folder.h"
#include "schema/maps/map_store.h"
#include "schema/merges/merge_state_store.h"
#include "schema/store_check.h"
#include "server/jobs/merge_jobs.h"
#include "tests/server/jobs/jobs_fixture.h"

namespace mapweld::server {
namespace {

// But for the matches, which the toys' verifier invents.
std::string findings_in(const Reader& db) {
  std::string all;
  for (const Finding& finding : check_store(db, {.max_findings = 1'000'000, .on_progress = {}}).findings) {
    if (finding.what.starts_with("a match names")) continue;
    all += finding.where + ": " + finding.what + "\n";
  }
  return all;
}

class MergeJobsRestart : public JobsOnToyMaps {
 protected:
  std::int64_t finish(std::int64_t id, JobState state) {
    EXPECT_EQ(wait(id).state, state);
    return id;
  }
  void damage(const std::string& sql) {
    WriteTransaction db = store_.write();
    db.connection().execute(sql);
    db.commit();
  }
};

TEST_F(MergeJobsRestart, FromEveryStateAtRestItEndsAsIfItHadNeverRun) {
  const std::uint64_t all = test::uninterrupted(world_).verifications;
  for (const JobState from :
       {JobState::kPaused, JobState::kBudgetExhausted, JobState::kCompleted, JobState::kCancelled, JobState::kFailed}) {
    SCOPED_TRACE(to_string(from));
    const std::int64_t id =
        submit(verifications(from == JobState::kCompleted ? all : 30), std::string(to_string(from)));
    finish(id, from == JobState::kCompleted ? JobState::kCompleted : JobState::kBudgetExhausted);
    if (from == JobState::kPaused) damage("UPDATE merges SET state = 'paused' WHERE id = " + std::to_string(id));
    if (from == JobState::kFailed) damage("UPDATE merges SET state = 'failed' WHERE id = " + std::to_string(id));
    if (from == JobState::kCancelled) jobs_->cancel(id);
    const MergeStatus before = jobs_->get(id);
    ASSERT_EQ(before.state, from);

    const MergeStatus begun = jobs_->restart(id, verifications(all + 1));
    EXPECT_EQ(begun.id, id);
    EXPECT_EQ(begun.map, before.map);
    EXPECT_EQ(begun.maps, before.maps);
    EXPECT_EQ(begun.method, before.method);
    EXPECT_EQ(begun.seed, before.seed);
    EXPECT_EQ(begun.parameters, before.parameters);
    EXPECT_EQ(begun.created_at, before.created_at);
    EXPECT_EQ(begun.budget, verifications(all + 1));
    EXPECT_EQ(begun.stop_reason, std::nullopt);
    finish(id, JobState::kCompleted);
    EXPECT_EQ(test::stored_state(store_, id), test::uninterrupted(world_));
    EXPECT_EQ(jobs_->get(id).candidates.verified, all);
    EXPECT_EQ(findings_in(store_.read()), "");
  }
}

TEST_F(MergeJobsRestart, NothingOfTheOldOneIsLeftBeforeTheFirstStep) {
  const std::int64_t id = finish(submit(verifications(30)), JobState::kBudgetExhausted);
  jobs_.reset();
  const MapRow map = *find_map(store_.read(), "ab");
  ASSERT_GT(map.edges, 0U);
  MergeJobs jobs(store_, test::job_options(verifier_));  // no worker: it stays queued
  const MergeStatus s = jobs.restart(id, std::nullopt);
  EXPECT_EQ(s.state, JobState::kQueued);
  EXPECT_EQ(s.phase, "voting");
  EXPECT_EQ(s.step, 0U);
  EXPECT_EQ(s.edges, 0U);
  EXPECT_EQ(s.confirmed_edges, 0U);
  EXPECT_EQ(s.candidates.verified, 0U);
  EXPECT_EQ(s.elapsed_s, 0);
  EXPECT_FALSE(s.checkpoint);
  EXPECT_EQ(s.budget, verifications(30));  // all of it anew
  EXPECT_EQ(s.remaining, verifications(30));
  EXPECT_TRUE(jobs.curve(id, 10, std::nullopt).items.empty());
  EXPECT_TRUE(jobs.edges(id, 10, std::nullopt).items.empty());
  const ReadTransaction db = store_.read();
  EXPECT_TRUE(load_checkpoint(db, JobId{id}).empty());
  EXPECT_FALSE(load_merge_state(db, JobId{id}));
  const MapRow after = *find_map(db, "ab");
  EXPECT_EQ(after.id, map.id);
  EXPECT_EQ(after.edges, 0U);
  EXPECT_EQ(after.vertices, map.vertices);
  EXPECT_GT(after.revision, map.revision);  // who keeps what it showed reads it again
  EXPECT_EQ(findings_in(db), "");
}

TEST_F(MergeJobsRestart, ADamagedMergeFailsSayingThatItHelpsAndItDoes) {
  const std::vector<std::string> damages = {
      "UPDATE checkpoints SET bytes = zeroblob(length(bytes)) WHERE part = 'similarity'",
      "DELETE FROM checkpoints WHERE part = 'state'",
      "UPDATE edges SET evidence = x'00' WHERE job IS NOT NULL",
      "DELETE FROM edges WHERE id = (SELECT max(id) FROM edges); UPDATE maps SET edges = edges - 1 WHERE kind = "
      "'merged';"
      "UPDATE merges SET edges = edges - 1",
      "UPDATE merges SET seed = seed + 1",
  };
  for (const std::string& sql : damages) {
    SCOPED_TRACE(sql);
    const std::int64_t id = finish(submit(verifications(30)), JobState::kBudgetExhausted);
    damage(sql);
    jobs_->resume(id, std::nullopt);
    finish(id, JobState::kFailed);
    EXPECT_NE(jobs_->get(id).error.value_or("").find("restart"), std::string::npos) << *jobs_->get(id).error;
    jobs_->restart(id, MergeBudget{});
    finish(id, JobState::kCompleted);
    EXPECT_EQ(findings_in(store_.read()), "");
    jobs_->remove(id);
  }
}

TEST_F(MergeJobsRestart, AFailureOfAnotherKindDoesNotSendAnybodyToIt) {
  verifier_->fails = true;
  const std::int64_t id = finish(submit(), JobState::kFailed);
  EXPECT_EQ(jobs_->get(id).error.value_or("").find("restart"), std::string::npos);
}

TEST_F(MergeJobsRestart, ItTakesInWhatTheMembersHaveGained) {
  const std::int64_t id = finish(submit(verifications(30)), JobState::kBudgetExhausted);
  const MapRow b = *find_map(store_.read(), "b");
  const MapRow before = *find_map(store_.read(), "ab");
  test::Random random(3);
  test::add_vertex(store_, b.id, b.vocabulary, "new", test::random_appearances(random, 20, 1'000));
  jobs_->restart(id, MergeBudget{});
  EXPECT_EQ(find_map(store_.read(), "ab")->vertices, before.vertices + 1);
  finish(id, JobState::kCompleted);
  EXPECT_EQ(test::stored_state(store_, id).vertices, before.vertices + 1);
  EXPECT_EQ(test::stored_state(store_, id).inherited_edges, 0U);
}

TEST_F(MergeJobsRestart, WhatMayNotBeRestartedIsAsItWas) {
  expect_code("no_such_merge", [&] { jobs_->restart(99, std::nullopt); });
  const std::int64_t ab = finish(submit(verifications(30)), JobState::kBudgetExhausted);
  expect_code("invalid_budget", [&] { jobs_->restart(ab, verifications(0)); });
  const MergeState state = test::stored_state(store_, ab);

  test::store_toy_maps(store_, world_, "c", "d");
  MergeRequest request = test::request_of(world_, "abc");
  request.maps = {"ab", "c"};
  const std::int64_t abc = finish(jobs_->submit(request).id, JobState::kCompleted);
  expect_code("map_in_use", [&] { jobs_->restart(ab, std::nullopt); });
  EXPECT_EQ(test::stored_state(store_, ab), state);
  EXPECT_EQ(jobs_->get(ab).state, JobState::kBudgetExhausted);

  verifier_->delay = std::chrono::milliseconds(20);
  jobs_->resume(ab, std::nullopt);
  expect_code("wrong_state", [&] { jobs_->restart(ab, std::nullopt); });   // it runs
  expect_code("wrong_state", [&] { jobs_->restart(abc, std::nullopt); });  // its member does
  jobs_->pause(ab);
  finish(jobs_->restart(abc, verifications(1)).id, JobState::kBudgetExhausted);
}

// The child restarts the merge again and again, the parent kills it at any moment and looks.
TEST_F(MergeJobsRestart, KilledMeanwhileItIsTheOldOneOrTheNew) {
  const std::int64_t id = finish(submit(verifications(60)), JobState::kBudgetExhausted);
  jobs_.reset();
  const MergeState old = test::stored_state(store_, id);
  store_.close();
  const std::filesystem::path data = store_.folder() / "data";
  const std::filesystem::path kept = store_.folder() / "kept";
  std::filesystem::copy(data, kept, std::filesystem::copy_options::recursive);
  test::Random random(5);
  int olds = 0, news = 0;
  for (int kill = 0; kill < 60; ++kill) {
    std::filesystem::remove_all(data);
    std::filesystem::copy(kept, data, std::filesystem::copy_options::recursive);
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      try {
        DataFolder folder(data);
        MergeJobs jobs(folder.store(), test::job_options(verifier_));
        if (::write(ready[1], "r", 1) != 1) ::_exit(1);
        jobs.restart(id, std::nullopt);
        ::pause();
      } catch (...) {
      }
      ::_exit(2);
    }
    ::close(ready[1]);
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    ::close(ready[0]);
    ::usleep(static_cast<useconds_t>(random.below(std::uint64_t{1} << (kill % 16))));  // up to 33 ms
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << status;

    store_.reopen();
    {
      const ReadTransaction db = store_.read();
      EXPECT_EQ(findings_in(db), "");
      const MergeRow row = *find_merge(db, JobId{id});
      const std::optional<MergeState> state = load_merge_state(db, JobId{id});
      if (state) {
        ++olds;
        EXPECT_EQ(*state, old);
        EXPECT_EQ(row.state, JobState::kBudgetExhausted);
        EXPECT_EQ(row.spent.verifications, 60U);
        EXPECT_FALSE(list_curve(db, row.id, 1).empty());
      } else {
        ++news;
        EXPECT_EQ(row.state, JobState::kQueued);
        EXPECT_EQ(row.spent, Spent{});
        EXPECT_TRUE(list_curve(db, row.id, 1).empty());
      }
    }
    store_.close();
  }
  EXPECT_GT(olds, 0);
  EXPECT_GT(news, 0);
  store_.reopen();
}

}  // namespace
}  // namespace mapweld::server
