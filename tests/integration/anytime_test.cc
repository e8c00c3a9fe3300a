// Budgets, stops and resumes through the real server; the same edges whatever the method; the same map whatever the
// number of threads.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/integration/map_images.h"
#include "tests/support/server_process.h"
#include "tests/support/temp_store.h"

namespace mapweld::testing {
namespace {

using EdgeSet = std::set<std::tuple<std::int64_t, std::int64_t, int>>;

EdgeSet edge_set(client::Client& client, std::int64_t merge) {
  EdgeSet set;
  for (const auto& edge : *client.merge_edges(merge)) set.emplace(edge.u, edge.v, edge.inliers);
  return set;
}

TEST(Anytime, AThirdOfTheTimeStopsInTimeAndResumeCompletes) {
  const auto& images = rendered_pair(90, 60, 5);
  const test::TempFolder folder;
  ServerProcess server(folder.path());
  client::Client client(server.url());
  upload(client, "a", images.a);
  upload(client, "b", images.b);

  contract::SubmitMerge request;
  request.maps = {"a", "b"};
  request.parameters.emplace().min_votes = 1;  // more candidates, a longer merge
  request.name = "whole";
  const auto whole = wait_for(client, client.submit_merge(request)->id);
  ASSERT_EQ(whole.state, "completed");
  // The quicker of two runs: a machine that was busy during one of them must not make the budget too large to be spent.
  request.name = "again";
  const auto again = wait_for(client, client.submit_merge(request)->id);
  const double third_s = std::min(whole.elapsed_s, again.elapsed_s) / 3;
  const auto expected = edge_set(client, whole.id);
  ASSERT_GT(expected.size(), 20u);

  request.name = "budgeted";
  request.budget.emplace().seconds = third_s;
  const auto id = client.submit_merge(request)->id;
  const auto stopped = wait_for(client, id);
  EXPECT_EQ(stopped.state, "budget_exhausted");
  EXPECT_EQ(stopped.stop_reason, "seconds");
  EXPECT_GE(stopped.elapsed_s, third_s / 2) << "the last checkpoint may be allowed for, by half of the budget at most";
  EXPECT_LT(stopped.candidates.verified, whole.candidates.verified);
  RecordProperty("seconds_over_budget", std::to_string(stopped.elapsed_s - third_s));

  const auto found = client.localize("budgeted", images.b[20].bytes);
  EXPECT_EQ(found->status, "localized");
  const auto so_far = edge_set(client, id);
  EXPECT_LT(so_far.size(), expected.size());
  EXPECT_TRUE(std::includes(expected.begin(), expected.end(), so_far.begin(), so_far.end()));

  client.resume_merge(id);
  EXPECT_EQ(wait_for(client, id).state, "completed");
  EXPECT_EQ(edge_set(client, id), expected);
}

TEST(Anytime, ABudgetOfVerificationsIsKeptToTheNumber) {
  const auto& images = rendered_pair(40, 30, 6);
  const test::TempFolder folder;
  ServerProcess server(folder.path());
  client::Client client(server.url());
  upload(client, "a", images.a);
  upload(client, "b", images.b);
  contract::SubmitMerge request;
  request.maps = {"a", "b"};
  request.name = "merged";
  request.budget.emplace().verifications = 17;
  const auto id = client.submit_merge(request)->id;
  auto stopped = wait_for(client, id);
  EXPECT_EQ(stopped.state, "budget_exhausted");
  EXPECT_EQ(stopped.stop_reason, "verifications");
  EXPECT_EQ(stopped.candidates.verified, 17);
  contract::Budget more;
  more.verifications = 5;
  client.resume_merge(id, more);
  stopped = wait_for(client, id);
  EXPECT_EQ(stopped.candidates.verified, 22) << "an allowance on top of what was spent";
}

TEST(Anytime, TermStopsWithinFiveSecondsAndTheMergeGoesOnByItself) {
  const auto& images = rendered_pair(90, 60, 5);
  const test::TempFolder folder;
  std::int64_t id = 0;
  std::int64_t step = 0;
  {
    ServerProcess server(folder.path());
    client::Client client(server.url());
    upload(client, "a", images.a);
    upload(client, "b", images.b);
    contract::SubmitMerge request;
    request.maps = {"a", "b"};
    request.name = "merged";
    request.parameters.emplace().min_votes = 1;
    id = client.submit_merge(request)->id;
    while (client.merge(id)->candidates.verified == 0) {
    }
    double seconds = 0;
    EXPECT_EQ(server.terminate(&seconds), 0);
    EXPECT_LT(seconds, 5.0);
  }
  ServerProcess server(folder.path());
  client::Client client(server.url());
  step = client.merge(id)->step;
  EXPECT_GT(step, 0) << "what was done before the stop is kept";
  EXPECT_EQ(wait_for(client, id).state, "completed");
}

TEST(SameEdges, QuickConnectAndBruteForceOnRenderedImages) {
  const auto& images = rendered_pair(90, 60, 5);
  const test::TempFolder folder;
  ServerProcess server(folder.path());
  client::Client client(server.url());
  upload(client, "a", images.a);
  upload(client, "b", images.b);
  const auto quick = merge(client, "a", "b", "quick", "quickconnect");
  const auto brute = merge(client, "a", "b", "brute", "brute-force");
  EXPECT_GT(quick.edges, 20);
  EXPECT_EQ(edge_set(client, quick.id), edge_set(client, brute.id));
}

// Everything about a map that its uploads determine.
std::string description(client::Client& client, const std::string& map) {
  std::string text;
  for (const auto& vertex : *client.vertices(map)) {
    text += vertex.name + " " + std::to_string(vertex.features) + " " + std::to_string(vertex.degree) + "\n";
  }
  for (const auto& image : *client.ignored(map)) {
    text += "ignored " + image.name + " " + std::to_string(image.similar_to) + "\n";
  }
  for (const auto& edge : *client.edges(map)) {
    text += std::to_string(edge.u) + "-" + std::to_string(edge.v) + " " + std::to_string(edge.votes) + " " +
            std::to_string(edge.inliers) + " " + std::to_string(edge.log10_false_alarms) + " " +
            (edge.confirmed ? "confirmed" : "withheld") + "\n";
  }
  return text;
}

// What the server thinks of the edges comes in the background, when the map has come to rest.
bool wait_until_judged(client::Client& client, const std::string& map) {
  for (int i = 0; i < 600; ++i) {
    const auto edges = client.edges(map);
    if (std::ranges::all_of(*edges, [](const auto& edge) { return edge.confidence.has_value(); })) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

TEST(SameMap, WhateverTheNumberOfThreads) {
  const auto& images = rendered_pair(90, 60, 5);
  const test::TempFolder folder;
  const auto photos = folder.path() / "photos";
  std::filesystem::create_directory(photos);
  for (const auto& image : images.a) std::ofstream(photos / image.name, std::ios::binary) << image.bytes;

  std::string expected;
  for (const int threads : {1, 2, 8}) {
    ServerProcess server(folder.path() / ("data-" + std::to_string(threads)),
                         {"--extract-threads", std::to_string(threads)});
    client::Client client(server.url());
    upload_folder(client, "a", photos, threads);
    ASSERT_TRUE(wait_until_judged(client, "a"));
    const auto got = description(client, "a");
    if (expected.empty()) expected = got;
    EXPECT_GT(std::count(got.begin(), got.end(), '-'), 50);
    EXPECT_EQ(got, expected) << threads << " threads";
  }
}

}  // namespace
}  // namespace mapweld::testing
