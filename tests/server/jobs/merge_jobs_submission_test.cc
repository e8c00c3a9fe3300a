// What may be submitted, and what is refused without a trace.
#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "client/contract/merge.h"
#include "core/merge/merge_options.h"
#include "schema/maps/map_store.h"
#include "server/jobs/merge_jobs.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

class MergeJobsSubmission : public ::testing::Test {
 protected:
  void SetUp() override {
    test::store_toy_maps(store_, world_);
    jobs_ = std::make_unique<MergeJobs>(store_,
                                        test::job_options(std::make_shared<test::HashVerifier>(world_.accept_share)));
  }
  void expect_refused(const std::string& code, const std::function<void(MergeRequest&)>& change) {
    MergeRequest request = test::request_of(world_);
    change(request);
    const std::uint64_t commits = store_.store().statistics().commits;
    try {
      jobs_->submit(request);
      ADD_FAILURE() << "not refused: " << code;
    } catch (const MergeJobError& error) {
      EXPECT_EQ(error.code(), code) << error.what();
    } catch (const contract::ContractError& error) {
      EXPECT_EQ(error.code().word(), code) << error.what();
    }
    EXPECT_EQ(store_.store().statistics().commits, commits);
    EXPECT_TRUE(jobs_->list(std::nullopt, 10, std::nullopt).items.empty());
    EXPECT_FALSE(find_map(store_.read(), "ab"));
  }

  test::ToyWorld world_ = test::toy_world(19);
  test::TempStore store_;
  std::unique_ptr<MergeJobs> jobs_;
};

// The client includes no core: both have the list.
TEST(MergeMethods, AreThoseThatTheContractNames) {
  EXPECT_TRUE(std::ranges::equal(merge_methods(), contract::kMergeMethods));
}

TEST_F(MergeJobsSubmission, RefusesBrokenRequests) {
  expect_refused("too_few_members", [](MergeRequest& r) { r.maps = {}; });
  expect_refused("too_few_members", [](MergeRequest& r) { r.maps = {"a"}; });
  expect_refused("duplicate_member", [](MergeRequest& r) { r.maps = {"a", "a"}; });
  expect_refused("no_such_map", [](MergeRequest& r) { r.maps = {"a", "nowhere"}; });
  expect_refused("name_taken", [](MergeRequest& r) { r.name = std::string("a"); });
  for (const char* name : {"", "..", "a b", "-x", "a/b"}) {
    expect_refused("invalid_name", [name](MergeRequest& r) { r.name = std::string(name); });
  }
  expect_refused("unknown_method", [](MergeRequest& r) { r.method = std::string("guess"); });
  expect_refused("unknown_method", [](MergeRequest& r) { r.method.clear(); });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.min_votes = 0; });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.min_votes = 65536; });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.min_inliers = -3; });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.max_false_alarms = 0; });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.max_false_alarms = NAN; });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.min_confidence = 1.001; });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.min_confidence = -0.001; });
  expect_refused("invalid_parameter", [](MergeRequest& r) { r.parameters.min_confidence = NAN; });
  expect_refused("invalid_budget", [](MergeRequest& r) { r.budget.seconds = 0; });
  expect_refused("invalid_budget", [](MergeRequest& r) { r.budget.seconds = -1.5; });
  expect_refused("invalid_budget", [](MergeRequest& r) { r.budget.seconds = INFINITY; });
  expect_refused("invalid_budget", [](MergeRequest& r) { r.budget.verifications = 0; });
  expect_refused("invalid_budget", [](MergeRequest& r) { r.budget.edges = 0; });
  expect_refused("invalid_budget", [](MergeRequest& r) { r.budget.fraction_of_maximum = 1.5; });
}

TEST_F(MergeJobsSubmission, RefusesMapsOfDifferentVocabularies) {
  const VocabularyId other = test::add_vocabulary(store_, "other");
  test::add_map(store_, "c", other);
  expect_refused("vocabulary_mismatch", [](MergeRequest& r) { r.maps = {"a", "c"}; });
}

TEST_F(MergeJobsSubmission, RefusesAMergedMapWithItsOwnMember) {
  jobs_->submit(test::request_of(world_, "first"));
  jobs_->cancel(1);
  MergeRequest request = test::request_of(world_, "second");
  request.maps = {"first", "b"};
  try {
    jobs_->submit(request);
    ADD_FAILURE() << "not refused";
  } catch (const MergeJobError& error) {
    EXPECT_EQ(error.code(), "duplicate_member");
  }
}

TEST_F(MergeJobsSubmission, RefusesAMemberThatIsStillBeingMerged) {
  test::store_toy_maps(store_, world_, "c", "d");
  jobs_->submit(test::request_of(world_, "first"));  // no worker runs: it stays queued
  MergeRequest request = test::request_of(world_, "second");
  request.maps = {"first", "c"};
  try {
    jobs_->submit(request);
    ADD_FAILURE() << "not refused";
  } catch (const MergeJobError& error) {
    EXPECT_EQ(error.code(), "wrong_state");
  }
  jobs_->pause(1);
  EXPECT_EQ(jobs_->submit(request).state, JobState::kQueued);
}

TEST_F(MergeJobsSubmission, FixesWatermarksWhenItIsMade) {
  const MergeStatus s = jobs_->submit(test::request_of(world_));
  EXPECT_EQ(s.state, JobState::kQueued);
  EXPECT_EQ(s.maps, (std::vector<std::string>{"a", "b"}));
  // The map grows before a worker comes: the merge does not see it.
  {
    const ReadTransaction db = store_.read();
    const auto a = find_map(db, "a");
    AppearanceVector image;
    image.width_px = 5000;
    image.height_px = 1;
    test::add_vertex(store_, a->id, a->vocabulary, "late", image);
  }
  jobs_->start();
  const MergeStatus done = jobs_->wait(s.id, std::chrono::seconds(60));
  EXPECT_EQ(done.state, JobState::kCompleted) << done.error.value_or("");
  EXPECT_EQ(test::stored_state(store_, s.id), test::uninterrupted(world_));
  EXPECT_EQ(find_map(store_.read(), "ab")->vertices, world_.sizes[0] + world_.sizes[1]);
}

TEST_F(MergeJobsSubmission, OfAnEmptyMapIsDoneAtOnce) {
  const auto vocabulary = find_map(store_.read(), "a")->vocabulary;
  test::add_map(store_, "empty", vocabulary);
  for (const std::string method : {"quickconnect", "brute-force", "random", "degree-min"}) {
    MergeRequest request = test::request_of(world_, method);
    request.method = method;
    request.maps = {"empty", "a"};
    jobs_->start();
    const MergeStatus s = jobs_->wait(jobs_->submit(request).id, std::chrono::seconds(60));
    EXPECT_EQ(s.state, JobState::kCompleted) << s.error.value_or("");
    EXPECT_EQ(s.phase, "done");
    EXPECT_EQ(s.edges, 0u);
    EXPECT_FALSE(jobs_->curve(s.id, 10, std::nullopt).items.empty());
  }
}

}  // namespace
}  // namespace mapweld::server
