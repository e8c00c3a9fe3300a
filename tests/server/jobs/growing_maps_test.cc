// Merges of maps that grow while they are merged.
#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "core/merge/merge_options.h"
#include "core/merge/run.h"
#include "schema/maps/map_store.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

using test::ToyWorld;
constexpr std::chrono::seconds kLong{60};

std::string code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const MergeJobError& error) {
    return error.code();
  }
  return "";
}

// Edges by the vertices' names in the toy world, which are their numbers in it.
using NamedEdges = std::set<std::pair<std::uint32_t, std::uint32_t>>;

NamedEdges edges_of(const MergeState& state) {
  NamedEdges edges;
  for (const MergeEdge& e : state.edges) edges.emplace(to_index(e.u), to_index(e.v));
  return edges;
}

class GrowingMaps : public ::testing::TestWithParam<std::string_view> {
 protected:
  GrowingMaps() {
    world_ = test::toy_world(19);
    world_.method = GetParam();
    world_.sizes = {30, 24};
    full_ = world_.sizes;
    {
      ToyWorld empty = world_;
      empty.sizes = {0, 0};
      test::store_toy_maps(store_, empty);
    }
    test::store_toy_vertices(store_, world_, {"a", "b"}, first_);
  }

  // What the job has, in the numbers of the toy world: a's vertices from 0, b's behind them.
  NamedEdges stored_edges(std::int64_t job) {
    NamedEdges edges;
    const auto number = [this](VertexId v) {
      const std::uint32_t n = to_index(v), fa = first_[0], fb = first_[1];
      if (n < fa) return n;
      if (n < fa + fb) return full_[0] + (n - fa);
      const std::uint32_t later = n - fa - fb, a_gained = full_[0] - fa;
      return later < a_gained ? fa + later : full_[0] + fb + (later - a_gained);
    };
    for (const MergeEdge& e : test::stored_state(store_, job).edges) {
      edges.insert(std::minmax(number(e.u), number(e.v)));
    }
    return edges;
  }

  ToyWorld world_;
  std::vector<std::uint32_t> full_;
  const std::vector<std::uint32_t> first_{12, 15};  // b is the larger before, a after
  test::TempStore store_;
};

TEST_P(GrowingMaps, ACompletedMergeTakesInWhatCameLater) {
  const auto verifier = std::make_shared<test::SlowVerifier>(world_.accept_share, std::chrono::microseconds(0));
  MergeJobs jobs(store_, test::job_options(verifier));
  jobs.start();
  const std::int64_t id = jobs.submit(test::request_of(world_)).id;
  const MergeStatus early = jobs.wait(id, kLong);
  ASSERT_EQ(early.state, JobState::kCompleted);
  EXPECT_EQ(code_of([&] { jobs.resume(id, std::nullopt); }), "nothing_to_resume");
  const std::uint64_t asked = verifier->calls;

  test::store_toy_vertices(store_, world_, {"a", "b"}, full_);
  EXPECT_EQ(find_map(store_.read(), "ab")->vertices, first_[0] + first_[1]) << "nothing shows beyond the watermark";
  MergeBudget budget;
  budget.verifications = 3;
  jobs.resume(id, budget);
  const MergeStatus stopped = jobs.wait(id, kLong);
  EXPECT_EQ(stopped.state, JobState::kBudgetExhausted) << stopped.error.value_or("");
  EXPECT_EQ(stopped.candidates.verified, early.candidates.verified + 3) << "all work done stays done";
  EXPECT_GE(stopped.candidates.known, stopped.candidates.verified);
  EXPECT_EQ(find_map(store_.read(), "ab")->vertices, full_[0] + full_[1]);
  jobs.resume(id, std::nullopt);
  const MergeStatus late = jobs.wait(id, kLong);
  ASSERT_EQ(late.state, JobState::kCompleted) << late.error.value_or("");
  const MergeState fresh = test::uninterrupted(world_);
  EXPECT_EQ(stored_edges(id), edges_of(fresh));
  EXPECT_EQ(late.candidates.verified, fresh.verifications);
  EXPECT_EQ(verifier->calls, fresh.verifications) << "nothing was verified twice";
  EXPECT_GT(early.edges, 20u);
  EXPECT_GT(late.edges, early.edges + 20u);
  EXPECT_GT(asked, 0u);
  EXPECT_EQ(code_of([&] { jobs.resume(id, std::nullopt); }), "nothing_to_resume");
}

TEST_P(GrowingMaps, APausedMergeTakesItInToo) {
  MergeJobs jobs(store_, test::job_options(std::make_shared<test::HashVerifier>(world_.accept_share)));
  jobs.start();
  MergeRequest request = test::request_of(world_);
  request.budget.verifications = 11;
  const std::int64_t id = jobs.submit(request).id;
  ASSERT_EQ(jobs.wait(id, kLong).state, JobState::kBudgetExhausted);
  test::store_toy_vertices(store_, world_, {"a", "b"}, full_);
  jobs.resume(id, std::nullopt);
  ASSERT_EQ(jobs.wait(id, kLong).state, JobState::kCompleted);
  EXPECT_EQ(stored_edges(id), edges_of(test::uninterrupted(world_)));
}

// The members grow, the merge is told to go on, and the server dies before the first checkpoint.
TEST_P(GrowingMaps, SurviveARestartBetweenGrowthAndCheckpoint) {
  std::int64_t id = 0;
  {
    MergeJobs jobs(store_, test::job_options(std::make_shared<test::HashVerifier>(world_.accept_share)));
    jobs.start();
    id = jobs.submit(test::request_of(world_)).id;
    ASSERT_EQ(jobs.wait(id, kLong).state, JobState::kCompleted);
  }
  test::store_toy_vertices(store_, world_, {"a", "b"}, full_);
  {
    MergeJobs jobs(store_, test::job_options(std::make_shared<test::HashVerifier>(world_.accept_share)));
    jobs.resume(id, std::nullopt);  // no worker: it stays queued
  }
  MergeJobs jobs(store_, test::job_options(std::make_shared<test::HashVerifier>(world_.accept_share)));
  jobs.start();
  ASSERT_EQ(jobs.wait(id, kLong).state, JobState::kCompleted);
  EXPECT_EQ(stored_edges(id), edges_of(test::uninterrupted(world_)));
}

INSTANTIATE_TEST_SUITE_P(Methods, GrowingMaps, ::testing::ValuesIn(test::methods_with_one_candidate_set()),
                         [](const auto& info) { return test::name_of_test(info.param); });

}  // namespace
}  // namespace mapweld::server
