// A merge that was killed with SIGKILL at random moments ends exactly like one that was never interrupted.
#include <algorithm>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "client/client.h"
#include "schema/engine/data_folder.h"
#include "schema/merges/merge_store.h"
#include "tests/integration/map_images.h"
#include "tests/support/server_process.h"
#include "tests/support/temp_store.h"

namespace mapweld::testing {
namespace {

// Many candidates, so that the merge is long; checkpoints often, so that a kill hits between two.
constexpr int kMinVotes = 1;
const std::vector<std::string> kOptions = {"--checkpoint-interval", "0.02"};

std::int64_t submit(client::Client& client, const std::string& method) {
  contract::SubmitMerge request;
  request.maps = {"a", "b"};
  request.name = "merged-" + method;
  request.method = method;
  request.parameters.emplace().min_votes = kMinVotes;
  return client.submit_merge(request)->id;
}

struct Outcome {
  std::vector<std::tuple<std::int64_t, std::int64_t, std::int64_t, int, std::int64_t>> edges;  // in order of insertion
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> checkpoint;
};

Outcome outcome_of(client::Client& client, std::int64_t merge, const std::filesystem::path& folder) {
  Outcome outcome;
  for (const auto& edge : *client.merge_edges(merge)) {
    outcome.edges.emplace_back(edge.u, edge.v, edge.votes, edge.inliers, edge.verifications);
  }
  DataFolderOptions inspect;
  inspect.access = DataFolderOptions::Access::kInspect;
  DataFolder data(folder, inspect);
  auto read = data.store().read();
  for (auto& part : load_checkpoint(read, static_cast<JobId>(merge))) {
    outcome.checkpoint.emplace_back(part.name, std::move(part.bytes));
  }
  return outcome;
}

class CrashResume : public ::testing::TestWithParam<const char*> {};

TEST_P(CrashResume, TwentyKillsChangeNothing) {
  const std::string method = GetParam();
  const auto& images = rendered_pair(90, 60, 5);

  const test::TempFolder folder;
  Outcome expected;
  double uninterrupted_s = 0;
  const auto merged_folder = folder.path() / "reference";
  const auto killed_folder = folder.path() / "killed";
  {
    ServerProcess server(merged_folder, kOptions);
    client::Client client(server.url());
    upload(client, "a", images.a);
    upload(client, "b", images.b);
    ASSERT_EQ(server.terminate(), 0);
  }
  std::filesystem::copy(merged_folder, killed_folder, std::filesystem::copy_options::recursive);
  {
    ServerProcess server(merged_folder, kOptions);
    client::Client client(server.url());
    const auto done = wait_for(client, submit(client, method));
    ASSERT_EQ(done.state, "completed");
    uninterrupted_s = done.elapsed_s;
    expected = outcome_of(client, done.id, merged_folder);
    ASSERT_GT(expected.edges.size(), 20u);
    ASSERT_FALSE(expected.checkpoint.empty());
  }

  // Moments are drawn over the merge's uninterrupted time; later lives begin where a checkpoint of earlier ones was.
  test::Random random(20);
  std::int64_t merge = 0;
  int kills = 0;
  int while_running = 0;
  std::int64_t furthest_step = 0;
  while (kills < 20) {
    ServerProcess server(killed_folder, kOptions);
    client::Client client(server.url());
    if (merge == 0) merge = submit(client, method);
    const auto state = *client.merge(merge);
    if (state.checkpoint) {
      EXPECT_GE(state.checkpoint->step, furthest_step) << "a checkpoint was lost";
      furthest_step = state.checkpoint->step;
    }
    if (state.state == "completed") {  // begin again: all twenty kills shall hit a merge that is under way
      EXPECT_EQ(outcome_of(client, merge, killed_folder).edges, expected.edges);
      client.delete_merge(merge);
      furthest_step = 0;
      merge = submit(client, method);
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(0.5 * uninterrupted_s * random.unit()));
    if (!contract::is_at_rest(client.merge(merge)->state)) ++while_running;
    server.kill();
    ++kills;
  }
  EXPECT_GE(while_running, 10) << "too few kills hit a running merge";

  ServerProcess server(killed_folder, kOptions);
  client::Client client(server.url());
  const auto done = wait_for(client, merge);
  ASSERT_EQ(done.state, "completed");
  const Outcome got = outcome_of(client, merge, killed_folder);
  EXPECT_EQ(got.edges, expected.edges);
  ASSERT_EQ(got.checkpoint.size(), expected.checkpoint.size());
  for (std::size_t i = 0; i < got.checkpoint.size(); ++i) {
    EXPECT_EQ(got.checkpoint[i].first, expected.checkpoint[i].first);
    EXPECT_TRUE(got.checkpoint[i].second == expected.checkpoint[i].second) << got.checkpoint[i].first;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, CrashResume, ::testing::Values("quickconnect", "brute-force", "spectral"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace mapweld::testing
