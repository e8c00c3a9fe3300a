// What a job does while nobody stops it: the merge of core, stored as it goes.
#include "server/jobs/merge_jobs.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "core/guard/alias_guard.h"
#include "core/merge/make_merger.h"
#include "core/merge/merge_metrics.h"
#include "core/merge/run.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "server/jobs/merge_watch.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

using test::ToyWorld;
constexpr std::chrono::seconds kLong{60};

std::vector<MergeEdgePoint> all_edges(const MergeJobs& jobs, std::int64_t id, std::size_t page_size) {
  std::vector<MergeEdgePoint> all;
  std::optional<std::string> after;
  do {
    const Page<MergeEdgePoint> page = jobs.edges(id, page_size, after);
    EXPECT_LE(page.items.size(), page_size);
    all.insert(all.end(), page.items.begin(), page.items.end());
    after = page.next;
  } while (after);
  return all;
}

TEST(MergeJobs, EndWithTheStateOfTheMergeInCore) {
  for (const std::string_view method : merge_methods()) {
    for (const std::uint32_t seed : {0u, 2u, 5u, 19u, 20u}) {
      ToyWorld world = test::toy_world(seed);
      world.method = method;
      test::TempStore store;
      test::store_toy_maps(store, world);
      const auto verifier = std::make_shared<test::HashVerifier>(world.accept_share);
      MergeJobs jobs(store, test::job_options(verifier));
      jobs.start();
      const MergeStatus submitted = jobs.submit(test::request_of(world));
      EXPECT_EQ(submitted.id, 1);
      const MergeStatus done = jobs.wait(submitted.id, kLong);
      ASSERT_EQ(done.state, JobState::kCompleted) << done.error.value_or("");
      const MergeState expected = test::uninterrupted(world);
      EXPECT_EQ(test::stored_state(store, submitted.id), expected) << method << " seed " << seed;
      EXPECT_EQ(find_map(store.read(), "ab")->edges, expected.edges.size());
    }
  }
}

TEST(MergeJobs, ShowEveryNumberOfTheFinishedMerge) {
  const ToyWorld world = test::toy_world(19);
  test::TempStore store;
  test::store_toy_maps(store, world);
  MergeJobs jobs(store, test::job_options(std::make_shared<test::HashVerifier>(world.accept_share)));
  jobs.start();
  const MergeStatus s = jobs.wait(jobs.submit(test::request_of(world)).id, kLong);

  const auto merger = make_merger(test::make_toy_merge(world));
  run(*merger, {});
  const MergeState& expected = merger->state();
  const MergeMetrics metrics = merge_metrics(merger->graph(), merger->input().members, expected.edges);
  EXPECT_EQ(s.method, "quickconnect");
  EXPECT_EQ(s.maps, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(s.map, "ab");
  EXPECT_EQ(s.seed, 19u);
  EXPECT_EQ(s.phase, "done");
  EXPECT_EQ(s.step, expected.step);
  EXPECT_EQ(s.words.done, merger->words_total());
  EXPECT_EQ(s.words.total, merger->words_total());
  EXPECT_EQ(s.candidates.known, expected.candidates_known);
  EXPECT_EQ(s.candidates.verified, expected.verifications);
  EXPECT_EQ(s.candidates.accepted, expected.edges.size());
  EXPECT_EQ(s.edges, expected.edges.size());
  EXPECT_EQ(s.components, metrics.components);
  EXPECT_EQ(s.algebraic_connectivity, metrics.algebraic_connectivity);
  EXPECT_EQ(s.largest_component.vertices, metrics.largest_vertices);
  EXPECT_EQ(s.largest_component.algebraic_connectivity, metrics.largest_algebraic_connectivity);
  ASSERT_EQ(s.joined.size(), 2u);
  EXPECT_EQ(s.joined[0].map, "a");
  EXPECT_EQ(s.joined[0].vertices, metrics.joined[0]);
  EXPECT_EQ(s.joined[1].vertices, metrics.joined[1]);
  EXPECT_EQ(s.independent_joins, metrics.independent_joins);
  EXPECT_GT(s.elapsed_s, 0);
  EXPECT_EQ(s.eta_s, std::nullopt);
  ASSERT_TRUE(s.checkpoint);
  EXPECT_EQ(s.checkpoint->step, expected.step);
  EXPECT_EQ(s.stop_reason, std::nullopt);
  EXPECT_EQ(s.error, std::nullopt);
}

TEST(MergeJobs, ListTheEdgesInOrderOfInsertion) {
  const ToyWorld world = test::toy_world(19);
  test::TempStore store;
  test::store_toy_maps(store, world);
  MergeJobs jobs(store, test::job_options(std::make_shared<test::HashVerifier>(world.accept_share)));
  jobs.start();
  const MergeStatus s = jobs.wait(jobs.submit(test::request_of(world)).id, kLong);
  const MergeState expected = test::uninterrupted(world);
  for (const std::size_t page_size : {7u, 1000u}) {
    const std::vector<MergeEdgePoint> edges = all_edges(jobs, s.id, page_size);
    ASSERT_EQ(edges.size(), expected.edges.size());
    double elapsed_s = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      EXPECT_EQ(edges[i].u, expected.edges[i].u);
      EXPECT_EQ(edges[i].v, expected.edges[i].v);
      EXPECT_EQ(edges[i].votes, expected.edges[i].votes);
      EXPECT_EQ(static_cast<int>(edges[i].inliers), expected.edges[i].verification.inliers);
      EXPECT_EQ(edges[i].verifications, expected.edges[i].verifications);
      EXPECT_GE(edges[i].elapsed_s, elapsed_s);
      elapsed_s = edges[i].elapsed_s;
    }
    EXPECT_LE(elapsed_s, s.elapsed_s);
  }
}

TEST(MergeJobs, DrawACurveFromTheFirstStepToTheLast) {
  const ToyWorld world = test::toy_world(19);
  test::TempStore store;
  test::store_toy_maps(store, world);
  const auto verifier = std::make_shared<test::SlowVerifier>(world.accept_share, std::chrono::microseconds(300));
  MergeJobs jobs(store, test::job_options(verifier));
  jobs.start();
  const MergeStatus s = jobs.wait(jobs.submit(test::request_of(world)).id, kLong);
  const Page<MergeCurvePoint> curve = jobs.curve(s.id, 1000, std::nullopt);
  EXPECT_EQ(curve.next, std::nullopt);
  ASSERT_GE(curve.items.size(), 4u);
  EXPECT_EQ(curve.items.front().step, 0u);
  EXPECT_EQ(curve.items.front().edges, 0u);
  EXPECT_EQ(curve.items.back().step, s.step);
  EXPECT_EQ(curve.items.back().phase, "done");
  EXPECT_EQ(curve.items.back().largest_component.algebraic_connectivity, s.largest_component.algebraic_connectivity);
  for (std::size_t i = 1; i < curve.items.size(); ++i) {
    EXPECT_GT(curve.items[i].step, curve.items[i - 1].step);
    EXPECT_GE(curve.items[i].elapsed_s, curve.items[i - 1].elapsed_s);
    EXPECT_GE(curve.items[i].edges, curve.items[i - 1].edges);
    EXPECT_LE(curve.items[i].components, curve.items[i - 1].components);
  }
  // Every value belongs to the edges of its moment: the same prefix of the merge gives it again.
  const auto merger = make_merger(test::make_toy_merge(world));
  const auto whole = make_merger(test::make_toy_merge(world));
  run(*whole, {});
  int certified_points = 0;
  for (const MergeCurvePoint& point : curve.items) {
    run(*merger, stop_when_merger([&](const Merger& m) { return m.state().step >= point.step; }, StopReason::kPaused));
    const MergeMetrics metrics = merge_metrics(merger->graph(), merger->input().members, merger->state().edges);
    EXPECT_EQ(point.components, metrics.components);
    EXPECT_NEAR(point.algebraic_connectivity, metrics.algebraic_connectivity, 1e-6 * metrics.algebraic_connectivity);
    EXPECT_NEAR(point.largest_component.algebraic_connectivity, metrics.largest_algebraic_connectivity,
                1e-6 * metrics.largest_algebraic_connectivity);
    EXPECT_EQ(point.verifications, merger->state().verifications);
    // No certificate says more than came true on the component that it was about.
    if (!point.certified_fraction) continue;
    const LargestComponentConnectivity now = largest_component_connectivity(merger->graph());
    const double at_end = algebraic_connectivity(induced_subgraph(whole->graph(), now.vertices)).value;
    EXPECT_LE(*point.certified_fraction * at_end, now.connectivity.value * (1 + 1e-9));
    ++certified_points;
  }
  EXPECT_GT(certified_points, 0);
  // Pages follow one another.
  const Page<MergeCurvePoint> first = jobs.curve(s.id, 2, std::nullopt);
  ASSERT_TRUE(first.next);
  EXPECT_EQ(jobs.curve(s.id, 1, first.next).items.front().step, curve.items[2].step);
}

TEST(MergeJobs, CanBePolledWhileTheyRun) {
  const ToyWorld world = test::toy_world(19);
  test::TempStore store;
  test::store_toy_maps(store, world);
  const auto verifier = std::make_shared<test::SlowVerifier>(world.accept_share, std::chrono::microseconds(1000));
  MergeJobOptions options = test::job_options(verifier);
  options.checkpoint_interval_s = 3600;  // so that fresh numbers cannot come from a checkpoint
  MergeJobs jobs(store, options);
  jobs.start();
  const std::int64_t id = jobs.submit(test::request_of(world)).id;
  MergeStatus before = jobs.get(id);
  int changes = 0;
  bool eta_seen = false;
  for (;;) {
    const MergeStatus s = jobs.get(id);
    if (s.state != JobState::kQueued && s.state != JobState::kRunning) break;
    EXPECT_GE(s.step, before.step);
    EXPECT_GE(s.edges, before.edges);
    EXPECT_GE(s.elapsed_s, before.elapsed_s);
    EXPECT_GE(s.independent_joins, before.independent_joins);
    EXPECT_LE(s.edges, s.candidates.verified);
    EXPECT_LE(s.candidates.verified, s.candidates.known);
    if (s.step > before.step) ++changes;
    if (s.eta_s) eta_seen = true;
    before = s;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_GE(changes, 5);
  EXPECT_TRUE(eta_seen);
  EXPECT_EQ(jobs.get(id).state, JobState::kCompleted);
}

TEST(MergeJobs, RunSideBySide) {
  const ToyWorld world = test::toy_world(19);
  test::TempStore store;
  test::store_toy_maps(store, world);
  MergeJobOptions options =
      test::job_options(std::make_shared<test::SlowVerifier>(world.accept_share, std::chrono::microseconds(50)));
  options.workers = 3;
  MergeJobs jobs(store, options);
  jobs.start();
  std::vector<std::int64_t> ids;
  for (const char* name : {"one", "two", "three", "four", "five"}) {
    ids.push_back(jobs.submit(test::request_of(world, name)).id);
  }
  const MergeState expected = test::uninterrupted(world);
  for (const std::int64_t id : ids) {
    EXPECT_EQ(jobs.wait(id, kLong).state, JobState::kCompleted);
    EXPECT_EQ(test::stored_state(store, id), expected);
  }
  const Page<MergeStatus> list = jobs.list(std::nullopt, 3, std::nullopt);
  ASSERT_EQ(list.items.size(), 3u);
  EXPECT_EQ(list.items[2].map, "three");
  ASSERT_TRUE(list.next);
  EXPECT_EQ(jobs.list(JobState::kCompleted, 10, list.next).items.size(), 2u);
  EXPECT_TRUE(jobs.list(JobState::kFailed, 10, std::nullopt).items.empty());
}

TEST(MergeJobs, TakeAMergedMapForAMember) {
  ToyWorld world = test::toy_world(19);
  test::TempStore store;
  test::store_toy_maps(store, world);
  ToyWorld third = world;
  third.sizes = {12, 1};
  test::store_toy_maps(store, third, "c", "d");
  const auto verifier = std::make_shared<test::HashVerifier>(world.accept_share);
  MergeJobs jobs(store, test::job_options(verifier));
  jobs.start();
  const MergeStatus ab = jobs.wait(jobs.submit(test::request_of(world)).id, kLong);
  MergeRequest request = test::request_of(world, "abc");
  request.maps = {"c", "ab"};
  const MergeStatus abc = jobs.wait(jobs.submit(request).id, kLong);
  ASSERT_EQ(abc.state, JobState::kCompleted) << abc.error.value_or("");
  EXPECT_EQ(abc.maps, (std::vector<std::string>{"c", "ab"}));

  // The same in core: members c (12) and ab (30 + 25), whose inner edges include its own inter edges.
  const MergeInput of_ab = test::make_toy_merge(world), of_c = test::make_toy_merge(third);
  MergeInput input;
  input.members = number_members({12, 55});
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (std::uint32_t v = 0; v < 12; ++v) vectors.push_back(of_c.appearances->appearances(VertexId{v}));
  for (std::uint32_t v = 0; v < 55; ++v) vectors.push_back(of_ab.appearances->appearances(VertexId{v}));
  input.appearances = std::make_shared<AppearanceTable>(vectors);
  for (const Edge& e : of_c.inner_edges) {
    if (to_index(e.v) < 12) input.inner_edges.push_back(e);
  }
  const auto shifted = [](VertexId v) { return VertexId{to_index(v) + 12}; };
  for (const Edge& e : of_ab.inner_edges) input.inner_edges.push_back({shifted(e.u), shifted(e.v), e.weight});
  for (const MergeEdge& e : test::uninterrupted(world).edges) {
    input.inner_edges.push_back({shifted(e.u), shifted(e.v), static_cast<std::uint32_t>(e.verification.inliers)});
  }
  input.verifier = verifier;
  input.options = {"quickconnect", world.min_votes, world.votes, world.seed};
  const auto merger = make_merger(input);
  run(*merger, {});
  EXPECT_EQ(test::stored_state(store, abc.id), merger->state());
  EXPECT_GT(merger->state().edges.size(), 20u);
}

// Also when it is stopped and resumed in between: confirmations may have changed by then.
TEST(MergeJobs, ConfirmWhatTheAliasGuardConfirms) {
  ToyWorld world = test::toy_world(19);
  world.sizes = {40, 30};
  world.words_per_image = 24;  // the verifier's matches name the first twenty
  test::TempStore store;
  test::store_toy_maps(store, world);
  MergeJobs jobs(store, test::job_options(std::make_shared<test::HashVerifier>(world.accept_share)));
  jobs.start();
  MergeRequest request = test::request_of(world);
  request.parameters.alias_guard = true;
  request.budget.edges = 60;
  const std::int64_t id = jobs.submit(request).id;
  std::uint64_t taken_back = 0;
  for (const bool whole : {false, true}) {
    if (whole) {
      // As if other images had confirmed all of them.
      {
        WriteTransaction db = store.write();
        const MapId map = find_merge(db, JobId{id})->map;
        std::vector<JudgedEdge> edges = load_judgements(db, map);
        for (JudgedEdge& edge : edges) {
          taken_back += edge.judgement.doubt != Reason::kNone ? 1 : 0;
          edge.judgement = {0.95, Reason::kNone, {}};
        }
        set_judgements(db, map, edges);
        db.commit();
      }
      jobs.resume(id, std::nullopt);
    }
    const MergeStatus s = jobs.wait(id, kLong);
    EXPECT_EQ(s.revoked, taken_back);
    ASSERT_EQ(s.state, whole ? JobState::kCompleted : JobState::kBudgetExhausted) << s.error.value_or("");
    const MergeState state = test::stored_state(store, id);
    const MergeInput input = test::make_toy_merge(world);
    // The stored inner edges have no matches.
    std::vector<VerifiedEdge> inner;
    for (const Edge& e : input.inner_edges) inner.push_back({e.u, e.v, {}});
    AliasGuard guard(input.members, inner, *input.appearances);
    const auto& verdicts = guard.verdicts(state.edges);
    const std::vector<EdgeRow> rows = list_merge_edges(store.read(), JobId{id}, 10000);
    ASSERT_EQ(rows.size(), verdicts.size());
    AppearanceGraph graph(70);
    for (std::size_t e = 0; e < inner.size(); ++e) {
      if (guard.inner_verdicts()[e].confirmed()) graph.add_edge(inner[e].u, inner[e].v, input.inner_edges[e].weight);
    }
    std::vector<MergeEdge> standing;
    for (std::size_t e = 0; e < rows.size(); ++e) {
      EXPECT_EQ(rows[e].confirmed, verdicts[e].confirmed());
      EXPECT_EQ(rows[e].doubt, std::string(to_string(verdicts[e].reason)));
      EXPECT_EQ(rows[e].confidence, verdicts[e].confidence);
      EXPECT_EQ(load_edge_evidence(store.read(), rows[e].id).made_of, evidence_items(verdicts[e].evidence));
      if (!verdicts[e].confirmed()) continue;
      standing.push_back(state.edges[e]);
      graph.add_edge(rows[e].u, rows[e].v, rows[e].inliers);
    }
    EXPECT_LT(standing.size(), rows.size()) << "edges at random are not what a guard confirms";
    const MergeMetrics metrics = merge_metrics(graph, input.members, standing);
    EXPECT_EQ(s.components, metrics.components);
    EXPECT_EQ(s.independent_joins, metrics.independent_joins);
    EXPECT_EQ(s.pairs.at(0).summary.confirmed, standing.size());
    EXPECT_EQ(s.edges, rows.size());
    EXPECT_EQ(s.confirmed_edges, standing.size());
    const MergeCurvePoint last = jobs.curve(id, 1000, std::nullopt).items.back();
    EXPECT_EQ(last.edges, rows.size());
    EXPECT_EQ(last.confirmed_edges, standing.size());
    if (whole) {
      EXPECT_EQ(s.certified_fraction, 1.0);
      EXPECT_GT(taken_back, 0u);
    }
  }
}

// While edges come nothing that was confirmed is taken back, so that `joined` only grows.
TEST(MergeWatch, ConfirmsAsTheGuardDoesAndRevokesNothing) {
  for (const double prior : {-3.5, 3.0}) {  // edges at random show nothing: none is confirmed, or all
    ToyWorld world = test::toy_world(19);
    world.sizes = {40, 30};
    world.words_per_image = 24;
    const MergeInput input = test::make_toy_merge(world);
    const auto merger = make_merger(input);
    GuardOptions options;
    options.model.prior = prior;
    MergeWatch watch(
        *merger, std::make_shared<AliasGuard>(input.members, std::vector<VerifiedEdge>{}, *input.appearances, options));
    std::vector<std::uint32_t> joined;
    while (!merger->done()) {
      for (int i = 0; i < 40 && !merger->done(); ++i) merger->step();
      watch.measure_edges(false);
      const auto verdicts = guard_edges(input.members, {}, merger->state().edges, *input.appearances, options);
      EXPECT_EQ(watch.confirmed_edges(),
                static_cast<std::uint64_t>(std::ranges::count_if(verdicts, &GuardVerdict::confirmed)));
      for (std::size_t m = 0; m < joined.size(); ++m) EXPECT_GE(watch.metrics().joined[m], joined[m]);
      joined = watch.metrics().joined;
    }
    EXPECT_EQ(watch.revoked(), 0u);
    EXPECT_EQ(watch.confirmed_edges(), prior > 0 ? merger->state().edges.size() : 0);
  }
}

TEST(MergeJobs, NothingIsAskedOfAConfirmedEdgeAtAConfidenceOfNought) {
  ToyWorld world = test::toy_world(19);
  world.sizes = {40, 30};
  world.words_per_image = 24;
  test::TempStore store;
  test::store_toy_maps(store, world);
  MergeJobs jobs(store, test::job_options(std::make_shared<test::HashVerifier>(world.accept_share)));
  jobs.start();
  MergeRequest request = test::request_of(world);
  request.parameters.alias_guard = true;
  request.parameters.min_confidence = 0;
  const MergeStatus s = jobs.wait(jobs.submit(request).id, kLong);
  ASSERT_EQ(s.state, JobState::kCompleted) << s.error.value_or("");
  EXPECT_EQ(s.parameters.min_confidence, 0);
  EXPECT_EQ(s.confirmed_edges, s.edges);
  bool is_any_doubtful = false;
  for (const EdgeRow& row : list_merge_edges(store.read(), JobId{s.id}, 10000)) {
    EXPECT_TRUE(row.confirmed);
    is_any_doubtful = is_any_doubtful || row.confidence < 0.5;
  }
  EXPECT_TRUE(is_any_doubtful) << "they are judged all the same";
}

}  // namespace
}  // namespace mapweld::server
