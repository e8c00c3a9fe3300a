// Merges of several maps, also of those that a former version left.
#include <algorithm>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/merge_options.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/merges/merge_store.h"
#include "tests/core/merge/verdict_log.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

using test::ToyWorld;
constexpr std::chrono::seconds kLong{60};

TEST(SeveralMapsMerged, EndWithTheStateOfTheMergeInCore) {
  for (const std::string_view method : merge_methods()) {
    ToyWorld world = test::toy_world(19);
    world.method = method;
    world.sizes = {9, 12, 7, 5};
    test::TempStore store;
    test::store_toy_maps(store, world);
    MergeJobOptions options = test::job_options(std::make_shared<test::HashVerifier>(world.accept_share));
    options.verify_threads = 2;
    MergeJobs jobs(store, options);
    jobs.start();
    const MergeStatus done = jobs.wait(jobs.submit(test::request_of(world)).id, kLong);
    ASSERT_EQ(done.state, JobState::kCompleted) << done.error.value_or("");
    EXPECT_EQ(test::stored_state(store, done.id), test::uninterrupted(world)) << method;
    EXPECT_EQ(done.joined.size(), 4u);
    if (method == "alignment") continue;  // random places make no sequences
    EXPECT_GT(done.edges, 20u);
    ASSERT_EQ(done.pairs.size(), 6u);
    std::uint64_t confirmed = 0, verified = 0;
    for (const JoinedPair& pair : done.pairs) {
      confirmed += pair.summary.confirmed;
      verified += pair.summary.verified;
      EXPECT_EQ(pair.summary.verdict, pair.summary.confirmed > 0 ? JoinVerdict::kJoined : JoinVerdict::kNotJoined);
    }
    EXPECT_EQ(confirmed, done.edges);
    EXPECT_EQ(verified, done.candidates.verified);
    EXPECT_EQ(done.certified_fraction, 1.0);
    EXPECT_EQ(done.estimated_fraction, 1.0);
    EXPECT_EQ(done.joinable_vertices, 0u);
  }
}

TEST(SeveralMapsMerged, SpectralSaysHowFarItIsOnceTheVotesAreIn) {
  ToyWorld world = test::toy_world(19);
  world.method = "spectral";
  world.sizes = {30, 40, 25, 20};
  test::TempStore store;
  test::store_toy_maps(store, world);
  const auto verifier = std::make_shared<test::SlowVerifier>(world.accept_share, std::chrono::microseconds(300));
  MergeJobOptions options = test::job_options(verifier);
  options.metrics_interval_s = 0.01;
  MergeJobs jobs(store, options);
  jobs.start();
  const MergeState whole = test::uninterrupted(world);
  ASSERT_GT(whole.verifications, 500u);
  MergeRequest request = test::request_of(world);
  request.budget.verifications = 200;
  const std::int64_t id = jobs.submit(request).id;
  std::uint64_t known = 0;
  int etas = 0;
  for (int runs = 0; runs < 3; ++runs) {
    for (;;) {
      const MergeStatus s = jobs.get(id);
      EXPECT_GE(s.candidates.known, known);
      known = s.candidates.known;
      if (s.phase == "verification" || s.phase == "done") {
        EXPECT_EQ(known, whole.candidates_known);
      }
      if (s.eta_s) ++etas;
      if (s.state != JobState::kQueued && s.state != JobState::kRunning) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    const MergeStatus stopped = jobs.get(id);
    EXPECT_TRUE(stopped.estimated_fraction) << runs;
    EXPECT_TRUE(stopped.certified_fraction) << runs;
    constexpr JobState kEnds[]{JobState::kBudgetExhausted, JobState::kBudgetExhausted, JobState::kCompleted};
    EXPECT_EQ(stopped.state, kEnds[runs]) << stopped.error.value_or("");
    EXPECT_EQ(stopped.stop_reason == "fraction_of_maximum", runs == 1);
    EXPECT_EQ(stopped.candidates.verified < whole.verifications, runs < 2);
    MergeBudget budget;
    if (runs == 0) budget.fraction_of_maximum = 0.5;
    if (runs < 2) jobs.resume(id, budget);
  }
  EXPECT_GT(etas, 5);
}

// A merge of four maps, stopped after 40 verifications, whose checkpoint is then made one of a program that went
// through the pairs of members one after the other.
class FormerMerge : public ::testing::Test {
 protected:
  explicit FormerMerge(double accept_share) {
    world_.method = "spectral";
    world_.sizes = {9, 12, 7, 5};
    world_.accept_share = accept_share;
    test::store_toy_maps(store_, world_);
    jobs_.emplace(store_, test::job_options(std::make_shared<test::HashVerifier>(accept_share)));
    jobs_->start();
    MergeRequest request = test::request_of(world_);
    request.budget.verifications = 40;
    id_ = jobs_->submit(request).id;
    stopped_ = jobs_->wait(id_, kLong);
  }

  void rewrite_checkpoint(const std::function<void(MergeState&)>& change) {
    ToyWorld by_pairs = world_;
    by_pairs.method = "brute-force";  // whose states tell of the members what spectral's told then
    MergeState state = test::stored_state(store_, id_);
    const std::uint64_t fingerprint = test::uninterrupted(by_pairs).input_fingerprint;
    ASSERT_NE(state.input_fingerprint, fingerprint);
    state.input_fingerprint = fingerprint;
    change(state);
    const std::vector<blobs::MergeStatePart> encoded = blobs::encode_merge_state(state, std::nullopt);
    std::vector<CheckpointPart> parts;
    for (const blobs::MergeStatePart& part : encoded) parts.push_back({part.name, part.bytes});
    WriteTransaction db = store_.write();
    const Timestamp now = find_merge(db, JobId{id_})->updated_at;
    ASSERT_TRUE(requeue_merge(db, JobId{id_}, std::nullopt, now));
    const std::optional<std::uint64_t> epoch = claim_merge(db, JobId{id_}, now);
    ASSERT_TRUE(epoch);
    CheckpointWrite checkpoint;
    checkpoint.step = state.step;
    checkpoint.phase = to_string(state.phase);
    checkpoint.spent = {1.0, state.verifications, state.edges.size()};
    checkpoint.parts = parts;
    checkpoint.now = now;
    ASSERT_TRUE(save_checkpoint(db, JobId{id_}, *epoch, checkpoint));
    ASSERT_TRUE(end_run(db, JobId{id_}, *epoch, {JobState::kPaused, "paused", std::nullopt, now}));
    db.commit();
  }

  MergeStatus go_on(const MergeBudget& budget) {
    jobs_->resume(id_, budget);
    for (;;) {
      const MergeStatus s = jobs_->get(id_);
      EXPECT_GE(s.candidates.known, stopped_.candidates.known);
      if (s.state != JobState::kQueued && s.state != JobState::kRunning) return s;
    }
  }

  void expect_goes_on(std::uint64_t verified) {
    ASSERT_EQ(stopped_.state, JobState::kBudgetExhausted);
    MergeBudget at_once;
    at_once.seconds = 1e-6;
    const MergeStatus voting = go_on(at_once);
    EXPECT_EQ(voting.state, JobState::kBudgetExhausted) << voting.error.value_or("");
    EXPECT_EQ(voting.phase, "voting");
    MergeBudget budget;
    budget.verifications = 7;
    const MergeStatus further = go_on(budget);
    EXPECT_EQ(further.state, JobState::kBudgetExhausted) << further.error.value_or("");
    EXPECT_EQ(further.candidates.verified, verified + 7);
    const MergeStatus done = go_on({});
    ASSERT_EQ(done.state, JobState::kCompleted) << done.error.value_or("");
    const MergeState whole = test::uninterrupted(world_);
    EXPECT_EQ(test::edge_set(test::stored_state(store_, id_)), test::edge_set(whole));
    EXPECT_EQ(done.candidates.verified, whole.verifications);
    EXPECT_EQ(done.candidates.known, whole.candidates_known);
  }

  ToyWorld world_ = test::toy_world(19);
  test::TempStore store_;
  std::optional<MergeJobs> jobs_;
  std::int64_t id_ = 0;
  MergeStatus stopped_;
};

struct FormerMergeWithEdges : FormerMerge {
  FormerMergeWithEdges() : FormerMerge(0.6) {}
};

TEST_F(FormerMergeWithEdges, GoesOnFromTheSecondPair) {
  rewrite_checkpoint([](MergeState& state) {
    EXPECT_FALSE(state.edges.empty());
    EXPECT_FALSE(state.rejected.empty());
    state.pair = 1;
    std::erase_if(state.search.postponed, [](const Candidate& c) { return to_index(c.target) >= 9; });
  });
  expect_goes_on(40);
}

struct FormerMergeWithoutEdges : FormerMerge {
  FormerMergeWithoutEdges() : FormerMerge(0) {}
};

// Nothing but the fingerprint tells such a state from one of today.
TEST_F(FormerMergeWithoutEdges, GoesOnFromBeforeTheFirstVerdict) {
  rewrite_checkpoint([](MergeState& state) {
    state.pair = 0;
    state.verifications = 0;
    state.rejected.clear();
    state.search.pending.clear();
    state.search.pending_next = 0;
    std::erase_if(state.search.postponed, [](const Candidate& c) { return to_index(c.target) >= 9; });
  });
  expect_goes_on(0);
}

}  // namespace
}  // namespace mapweld::server
