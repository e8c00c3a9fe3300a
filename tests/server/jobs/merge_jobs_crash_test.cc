// Kill -9 at random moments: a merge that is killed again and again ends like one that never was.
#include <cstdio>
#include <exception>
#include <random>
#include <string>
#include <tuple>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/merge/merge_options.h"
#include "schema/engine/data_folder.h"
#include "server/jobs/merge_jobs.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

using test::ToyWorld;
constexpr int kKills = 10;  // of each method with each number of threads

// In the child: opens the folder as a server does, lets the job go on by itself, and leaves when it is at rest.
[[noreturn]] void serve(const std::filesystem::path& folder, const ToyWorld& world, int threads, std::int64_t job) {
  try {
    DataFolder data(folder);
    const auto verifier =
        std::make_shared<test::SlowVerifier>(world.accept_share, std::chrono::microseconds(1000 * threads));
    MergeJobOptions options = test::job_options(verifier);
    options.verify_threads = threads;
    options.checkpoint_interval_s = 0.004;
    options.checkpoint_cost_share = 0.5;
    options.metrics_interval_s = 0.01;
    MergeJobs jobs(data.store(), options);
    jobs.start();
    const MergeStatus s = jobs.wait(job, std::chrono::seconds(120));
    jobs.shutdown();
    if (s.state != JobState::kCompleted) std::fprintf(stderr, "%s\n", s.error.value_or("not at rest").c_str());
    ::_exit(s.state == JobState::kCompleted ? 0 : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    ::_exit(2);
  }
}

pid_t start_server(const std::filesystem::path& folder, const ToyWorld& world, int threads, std::int64_t job) {
  const pid_t child = ::fork();
  if (child == 0) serve(folder, world, threads, job);
  return child;
}

class MergeJobsCrash : public ::testing::TestWithParam<std::tuple<std::string_view, int>> {};

TEST_P(MergeJobsCrash, KilledAtRandomMomentsEndsTheSame) {
  const auto [method, threads] = GetParam();
  ToyWorld world = test::toy_world(19);
  world.method = method;
  world.votes = VoteRule::kSignatures;
  world.sizes = {60, 40};
  test::TempStore store;
  test::store_toy_maps(store, world);
  std::int64_t job = 0;
  {
    MergeJobs jobs(store, test::job_options(std::make_shared<test::HashVerifier>(world.accept_share)));
    job = jobs.submit(test::request_of(world)).id;  // queued: nothing runs in this process
  }
  store.close();

  std::mt19937 random(7);
  int kills_while_running = 0;
  std::uint64_t before = 0;
  for (int kill = 0; kill < kKills; ++kill) {
    const pid_t child = start_server(store.folder() / "data", world, threads, job);
    ASSERT_GT(child, 0);
    ::usleep(1000 * static_cast<useconds_t>(15 + random() % 70));
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
    store.reopen();
    const auto row = find_merge(store.read(), JobId{job});
    ASSERT_TRUE(row);
    if (row->state == JobState::kRunning) ++kills_while_running;
    EXPECT_GE(row->spent.verifications, before);
    before = row->spent.verifications;
    if (row->step > 0) {
      // Whatever was on disk is one consistent moment of the merge.
      const MergeState state = test::stored_state(store, job);
      EXPECT_EQ(state.step, row->step);
      EXPECT_EQ(state.verifications, row->spent.verifications);
      EXPECT_EQ(state.edges.size(), row->spent.edges);
      EXPECT_EQ(find_map(store.read(), row->map)->edges, row->spent.edges);
    }
    store.close();
  }
  EXPECT_GE(kills_while_running, kKills / 2) << "the merge is over too soon for this test";

  const pid_t child = start_server(store.folder() / "data", world, threads, job);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  ASSERT_EQ(WEXITSTATUS(status), 0);
  store.reopen();
  // Edges, weights, order, S, queue, lists, verdicts: everything.
  EXPECT_EQ(test::stored_state(store, job), test::uninterrupted(world));
}

INSTANTIATE_TEST_SUITE_P(Methods, MergeJobsCrash,
                         ::testing::Combine(::testing::ValuesIn(merge_methods()), ::testing::Values(1, 2, 4)),
                         [](const auto& info) {
                           return test::name_of_test(std::get<0>(info.param)) + "On" +
                                  std::to_string(std::get<1>(info.param)) + "Threads";
                         });

}  // namespace
}  // namespace mapweld::server
