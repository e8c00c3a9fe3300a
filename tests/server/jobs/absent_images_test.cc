// Merges of maps whose images are deleted, restored and purged. A verdict is a function of its pair, and so is what is
// a candidate: what a merge must end with is what the undisturbed one has, less the edges of absent images.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/merge_options.h"
#include "schema/maps/map_store.h"
#include "schema/maps/purge.h"
#include "schema/maps/vertex_removal.h"
#include "schema/store_check.h"
#include "server/jobs/merge_check.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

constexpr std::chrono::seconds kLong{60};
using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

class AbsentImages : public ::testing::TestWithParam<std::string_view> {
 protected:
  AbsentImages() {
    world_.method = GetParam();
    world_.sizes = {24, 20};
    test::store_toy_maps(store_, world_);
    open();
  }

  void open() {
    jobs_ = std::make_unique<MergeJobs>(store_, test::job_options(verifier_));
    jobs_->start();
  }
  void restart() {
    jobs_.reset();
    store_.reopen();
    open();
  }

  // In merged numbers: a's first.
  std::pair<std::string, VertexId> home_of(std::uint32_t v) const {
    return v < world_.sizes[0] ? std::pair("a", VertexId{v}) : std::pair("b", VertexId{v - world_.sizes[0]});
  }
  void remove(const std::set<std::uint32_t>& vertices) {
    WriteTransaction db = store_.write();
    for (const std::uint32_t v : vertices) {
      const auto [map, number] = home_of(v);
      EXPECT_EQ(delete_vertices(db, find_map(db, map)->id, number, 1, test::at(9)), 1u);
    }
    db.commit();
  }
  void restore(const std::set<std::uint32_t>& vertices) {
    WriteTransaction db = store_.write();
    for (const std::uint32_t v : vertices) {
      const auto [map, number] = home_of(v);
      EXPECT_TRUE(restore_vertex(db, find_map(db, map)->id, number));
    }
    db.commit();
  }

  MergeStatus run(std::optional<std::uint64_t> verifications = {}) {
    MergeBudget budget;
    budget.verifications = verifications;
    return run(budget);
  }
  MergeStatus run(const MergeBudget& budget) {
    if (id_ == 0) {
      MergeRequest request = test::request_of(world_);
      request.budget = budget;
      id_ = jobs_->submit(request).id;
    } else {
      jobs_->resume(id_, budget);
    }
    return jobs_->wait(id_, kLong);
  }

  Pairs edges() {
    Pairs pairs;
    for (const MergeEdgePoint& edge : jobs_->edges(id_, 10'000, std::nullopt).items) {
      pairs.emplace(to_index(edge.u), to_index(edge.v));
    }
    return pairs;
  }
  Pairs expected(const std::set<std::uint32_t>& absent) {
    Pairs pairs;
    for (const MergeEdge& edge : test::uninterrupted(world_).edges) {
      if (absent.contains(to_index(edge.u)) || absent.contains(to_index(edge.v))) continue;
      pairs.emplace(to_index(edge.u), to_index(edge.v));
    }
    return pairs;
  }
  void expect_sound() {
    const ReadTransaction db = store_.read();
    for (const Finding& finding : check_store(db).findings) {
      if (finding.what.starts_with("a match names a feature")) continue;  // the verifier invents them
      ADD_FAILURE() << finding.where << ": " << finding.what;
    }
    const MergeCheck check = check_merge(db, *find_merge(db, JobId{id_}), test::job_options(verifier_).verifier);
    for (const std::string& what : check.findings) ADD_FAILURE() << what;
  }
  bool has_nothing_to_resume() {
    try {
      jobs_->resume(id_, std::nullopt);
      jobs_->wait(id_, kLong);
    } catch (const MergeJobError& error) {
      return error.code() == "nothing_to_resume";
    }
    return false;
  }

  test::ToyWorld world_ = test::toy_world(19);
  test::TempStore store_;
  std::shared_ptr<test::SlowVerifier> verifier_ =
      std::make_shared<test::SlowVerifier>(world_.accept_share, std::chrono::microseconds(0));
  std::unique_ptr<MergeJobs> jobs_;
  std::int64_t id_ = 0;
};

TEST_P(AbsentImages, APausedMergeGoesOnWithoutThemAndWithThemWhenTheyAreBack) {
  const std::set<std::uint32_t> gone = {0, 3, 7, 24, 30, 43};
  const Pairs all = expected({});
  ASSERT_LT(expected(gone).size(), all.size());
  run(all.size() / 2);
  const Pairs early = edges();
  ASSERT_FALSE(early.empty());

  remove(gone);
  for (const auto& [u, v] : edges()) EXPECT_FALSE(gone.contains(u) || gone.contains(v));
  expect_sound();
  restart();
  const MergeStatus late = run();
  ASSERT_EQ(late.state, JobState::kCompleted) << late.error.value_or("");
  EXPECT_EQ(edges(), expected(gone));
  EXPECT_EQ(late.edges, expected(gone).size());
  EXPECT_EQ(find_map(store_.read(), "ab")->edges, expected(gone).size());
  EXPECT_EQ(late.candidates.verified, verifier_->calls) << "what was verified stays counted";
  EXPECT_TRUE(has_nothing_to_resume());
  expect_sound();

  restore({3, 24});
  restart();
  expect_sound();
  ASSERT_EQ(run().state, JobState::kCompleted);
  EXPECT_EQ(edges(), expected({0, 7, 30, 43}));
  restore({0, 7, 30, 43});
  ASSERT_EQ(run().state, JobState::kCompleted);
  EXPECT_EQ(edges(), all);
  EXPECT_EQ(verifier_->calls, test::uninterrupted(world_).verifications) << "nothing was verified twice";
  EXPECT_TRUE(has_nothing_to_resume());
  expect_sound();
}

TEST_P(AbsentImages, DeletedAndRestoredMeanwhileNothingHasHappened) {
  run(20);
  const MergeState before = test::stored_state(store_, id_);
  const MergeStatus told = jobs_->get(id_);
  remove({1, 2, 25, 26, 27});
  EXPECT_EQ(test::stored_state(store_, id_), before) << "a checkpoint stays what it was";
  EXPECT_TRUE(jobs_->get(id_).is_outdated);
  restore({25, 1, 27, 2, 26});
  EXPECT_EQ(test::stored_state(store_, id_), before);
  EXPECT_FALSE(jobs_->get(id_).is_outdated);
  EXPECT_EQ(jobs_->get(id_).edges, told.edges);
  ASSERT_EQ(run().state, JobState::kCompleted);
  EXPECT_EQ(test::stored_state(store_, id_), test::uninterrupted(world_));
}

TEST_P(AbsentImages, AMergeThatBeginsOrBeginsAfreshWithoutThemDoesNotKnowThem) {
  const std::set<std::uint32_t> gone = {5, 6, 28};
  remove(gone);
  ASSERT_EQ(run().state, JobState::kCompleted);
  EXPECT_EQ(edges(), expected(gone));
  EXPECT_TRUE(has_nothing_to_resume());
  restore({5});
  remove({8});
  jobs_->restart(id_, std::nullopt);
  ASSERT_EQ(jobs_->wait(id_, kLong).state, JobState::kCompleted);
  EXPECT_EQ(edges(), expected({6, 8, 28}));
  expect_sound();
  restore({6, 8, 28});
  ASSERT_EQ(run().state, JobState::kCompleted);
  EXPECT_EQ(edges(), expected({}));
  expect_sound();
}

TEST_P(AbsentImages, ABudgetOfEdgesIsOnTopOfThoseThatAreThere) {
  MergeBudget two;
  two.edges = 2;
  ASSERT_EQ(run(two).state, JobState::kBudgetExhausted);
  run(two);
  ASSERT_EQ(edges().size(), 4u);
  const auto [u, v] = *edges().begin();
  remove({u, v});
  std::size_t there = edges().size();
  ASSERT_LT(there, 4u);
  ASSERT_EQ(run(two).state, JobState::kBudgetExhausted);
  EXPECT_EQ(edges().size(), there + 2);
  restore({u, v});
  there = edges().size();
  ASSERT_EQ(run(two).state, JobState::kBudgetExhausted);
  EXPECT_EQ(edges().size(), there + 2);
}

TEST_P(AbsentImages, PurgedImagesLeaveAStateToGoOnFrom) {
  run(expected({}).size() / 2);
  remove({0, 3, 24, 30});
  restore({3});
  jobs_.reset();
  {
    WriteTransaction db = store_.write();
    for (const char* map : {"a", "b"}) purge_deleted(db, find_map(db, map)->id);
    db.commit();
  }
  restart();
  expect_sound();
  remove({7});
  ASSERT_EQ(run().state, JobState::kCompleted);
  EXPECT_EQ(edges(), expected({0, 7, 24, 30}));
  restore({7});
  ASSERT_EQ(run().state, JobState::kCompleted);
  EXPECT_EQ(edges(), expected({0, 24, 30}));
  expect_sound();
}

INSTANTIATE_TEST_SUITE_P(Methods, AbsentImages, ::testing::ValuesIn(test::methods_with_one_candidate_set()),
                         [](const auto& info) { return test::name_of_test(info.param); });

}  // namespace
}  // namespace mapweld::server
