#include "core/merge/spectral/spectral.h"

#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/fingerprint.h"
#include "core/graph/components.h"
#include "core/merge/make_merger.h"
#include "tests/core/merge/spectral/quickconnect_oracle.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"

namespace mapweld {
namespace {

MergeInput make(test::ToyWorld world, const char* method) {
  world.method = method;
  return make_toy_merge(world);
}

StopCondition stop_at_step(std::uint64_t step) {
  return stop_when_merger([step](const Merger& m) { return m.state().step >= step; }, StopReason::kPaused);
}

TEST(Spectral, EndsWithTheEdgesOfBruteForce) {
  for (std::uint32_t seed = 0; seed < 80; ++seed) {
    const test::ToyWorld world = seed < 70 ? test::toy_world(seed) : test::long_toy_world(seed);
    const auto ours = make_merger(make(world, "spectral")), brute = make_merger(make(world, "brute-force"));
    run(*ours, {});
    run(*brute, {});
    EXPECT_EQ(test::edge_set(ours->state()), test::edge_set(brute->state())) << seed;
    EXPECT_EQ(ours->state().verifications, brute->state().verifications) << seed;
    EXPECT_EQ(ours->state().candidates_known, brute->state().candidates_known) << seed;
  }
}

TEST(Spectral, MakesAtMostOneVerificationAStepAndSaysItsPhases) {
  const auto merger = make_merger(make(test::long_toy_world(1), "spectral"));
  EXPECT_EQ(merger->state().phase, MergePhase::kVoting);
  std::uint64_t before = 0;
  run(*merger, {}, [&](const Merger& m) {
    const MergeState& state = m.state();
    EXPECT_LE(state.verifications, before + 1);
    before = state.verifications;
    const MergePhase phase = state.step < 45 ? MergePhase::kVoting : MergePhase::kVerification;
    EXPECT_EQ(state.phase, m.done() ? MergePhase::kDone : phase);
    EXPECT_EQ(state.verifications, state.edges.size() + state.rejected.size());
  });
}

TEST(Spectral, GoesOnExactlyWhereItStoppedWhereverThatWas) {
  const MergeInput input = make(test::long_toy_world(3), "spectral");
  const auto whole = make_merger(input);
  run(*whole, {});
  ASSERT_GT(whole->state().verifications, 300u);
  for (std::uint64_t k = 0; k <= whole->state().step; k += k < 200 ? 1 : 11) {
    const auto first = make_merger(input);
    run(*first, stop_at_step(k));
    const auto second = make_merger(input, first->state());
    run(*second, {});
    ASSERT_EQ(second->state(), whole->state()) << k;
  }
}

// In slices of one row and of a few: they change nothing, and a merge goes on from between them.
TEST(Spectral, MakesItsOrderInStepsThatLeaveTheStateAsItIs) {
  const MergeInput input = make(test::long_toy_world(5), "spectral");
  const auto whole = make_merger(input);
  run(*whole, {});
  for (const std::uint32_t odds_at_once : {1u, 40u}) {
    SpectralOptions options;
    options.odds_at_once = odds_at_once;
    Spectral sliced(input, options);
    run(sliced, stop_when_merger([](const Merger& m) { return m.state().phase == MergePhase::kVerification; },
                                 StopReason::kPaused));
    const MergeState before = sliced.state();
    std::uint32_t slices = 0;
    for (; sliced.state().search.pending.empty(); ++slices) {
      ASSERT_EQ(sliced.state(), before);
      ASSERT_EQ(sliced.open_candidates(), before.search.postponed);
      if (slices % 8 == 3) {
        const auto resumed = make_merger(input, sliced.state());
        run(*resumed, {});
        ASSERT_EQ(resumed->state(), whole->state());
      }
      sliced.step();
    }
    EXPECT_GT(slices, 10u);
    run(sliced, {});
    EXPECT_EQ(sliced.state(), whole->state());
  }
}

// Told from the verdicts alone, with components and epochs found anew.
TEST(Spectral, GivesItsShareToQuickConnectsOrder) {
  const SpectralOptions options;
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    test::ToyWorld world = test::long_toy_world(seed);
    if (seed >= 8) world.sizes = {30, 45, 25, 20};
    const auto merger = make_merger(make(world, "spectral"));
    const std::vector<test::OracleVerdict> verdicts = test::log_verdicts(*merger);
    const std::vector<Candidate> all = merger->state().search.postponed;
    const std::uint32_t n = merger->graph().vertices();
    AppearanceGraph graph(n, merger->input().inner_edges);
    std::vector<bool> is_joined(n, false), has_verdict(all.size(), false);
    std::vector<test::QuickConnectKey> keys;
    std::uint64_t given = 0, next_epoch = 0, epochs = 0;
    std::uint32_t largest_then = 0;
    for (std::size_t begin = 0; begin < verdicts.size();) {
      const Components components = connected_components(graph);
      const std::uint32_t largest = components.sizes[components.largest()];
      if (begin >= next_epoch || largest > largest_then + largest_then / options.growth_part) {
        next_epoch = begin + std::max<std::uint64_t>(
                                 {options.least_epoch, n / options.epoch_vertices, begin / options.epoch_part});
        largest_then = largest;
        keys = test::quickconnect_order(all, has_verdict, is_joined, graph);
        ++epochs;
      }
      const std::size_t end = std::min<std::size_t>(
          verdicts.size(), begin + std::max<std::size_t>(options.least_batch, begin / options.batch_part));
      const std::vector<bool> was_joined = is_joined;
      for (std::size_t i = begin; i < end; ++i) {
        const auto taken = static_cast<std::size_t>(std::ranges::find_if(all,
                                                                         [&](const Candidate& c) {
                                                                           return c.source == verdicts[i].source &&
                                                                                  c.target == verdicts[i].target;
                                                                         }) -
                                                    all.begin());
        ASSERT_LT(taken, all.size());
        ASSERT_FALSE(has_verdict[taken]);
        if ((i + 1) % options.quickconnect_share == 0) {
          std::optional<std::size_t> expected, passed_over;
          for (const test::QuickConnectKey& key : keys) {
            const auto& [was_joined_then, not_best, degree, votes, c] = key;
            if (has_verdict[c]) continue;
            const bool is_passed_over = !was_joined_then && was_joined[to_index(all[c].source)];
            std::optional<std::size_t>& first = is_passed_over ? passed_over : expected;
            if (!first) first = c;
          }
          EXPECT_EQ(taken, expected ? *expected : *passed_over) << "seed " << seed << ", verification " << i + 1;
          ++given;
        }
        has_verdict[taken] = true;
      }
      for (std::size_t i = begin; i < end; ++i) {
        if (!verdicts[i].accepted) continue;
        graph.add_edge(verdicts[i].source, verdicts[i].target, 1);
        is_joined[to_index(verdicts[i].source)] = is_joined[to_index(verdicts[i].target)] = true;
      }
      begin = end;
    }
    EXPECT_EQ(given, verdicts.size() / options.quickconnect_share);
    EXPECT_GT(epochs, 5u);
  }
}

// Candidates of one place all look alike; what the verifier passes there it passes everywhere, so only the gain tells
// them apart.
TEST(Spectral, MendsTheWeakestPlaceFirst) {
  // Two walks of 60 images that share their beginning and their end: the first join makes a chain of 120, the far ends
  // of which are the weak place.
  const std::uint32_t n = 60;
  AppearanceGraph graph(2 * n);
  for (const std::uint32_t first : {0u, n}) {
    for (std::uint32_t v = first + 1; v < first + n; ++v) graph.add_edge(VertexId{v - 1}, VertexId{v}, 20);
  }
  std::vector<VertexId> sources, targets;
  for (std::uint32_t v = 0; v < n; ++v) {
    targets.push_back(VertexId{v});
    sources.push_back(VertexId{n + v});
  }
  std::vector<CandidateEvidence::Cell> cells;
  for (std::uint32_t v = 0; v < n; ++v) cells.push_back({v, v, 30});
  SpectralOptions options;
  options.quickconnect_share = 1000;
  options.least_batch = options.least_epoch = 1;
  options.epoch_vertices = 1000;
  SpectralOrder order(graph, sources, targets, cells, std::vector<float>(cells.size(), 0), options);
  const std::vector<std::uint32_t> first = order.next_batch();
  ASSERT_EQ(first.size(), 1u);
  order.note({first[0], true});
  EXPECT_EQ(first[0], 0u);  // all alike: the lowest number
  const std::vector<std::uint32_t> second = order.next_batch();
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0], n - 1);
  order.note({second[0], true});
  const std::vector<std::uint32_t> third = order.next_batch();
  EXPECT_NEAR(third[0], n / 2, 3);  // a ring of 120: across its middle
}

// The same in every build and on every processor, as recorded once with the model as it is.
TEST(Spectral, VerifiesTwoMembersInTheRecordedOrder) {
  const auto order_of = [](const test::ToyWorld& world) {
    const auto merger = make_merger(make(world, "spectral"));
    Fingerprint hash;
    for (const test::OracleVerdict& v : test::log_verdicts(*merger)) {
      hash.add(to_index(v.source));
      hash.add(to_index(v.target));
      hash.add(v.accepted ? 1 : 0);
    }
    return hash.value();
  };
  Fingerprint toys, walks;
  for (std::uint32_t seed = 0; seed < 40; ++seed) toys.add(order_of(test::toy_world(seed)));
  for (std::uint32_t seed = 0; seed < 4; ++seed) walks.add(order_of(test::long_toy_world(seed)));
  EXPECT_EQ(toys.value(), 17381846647901069397u);
  EXPECT_EQ(walks.value(), 16076668685580989259u);
}

// Four walks that all meet: an edge that joins two of them is worth more than one between joined ones, whichever pair
// of members has it.
TEST(Spectral, JoinsAllMembersBeforeItStrengthens) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    test::ToyWorld world = test::long_toy_world(seed);
    world.sizes = {50, 40, 30, 20};
    world.accept_share = 0.5;
    const auto merger = make_merger(make(world, "spectral"));
    run(*merger, stop_at_verifications(40));
    EXPECT_EQ(connected_components(merger->graph()).count(), 1u) << seed;
    const auto by_pairs = make_merger(make(world, "quickconnect"));
    run(*by_pairs, stop_at_verifications(40));
    EXPECT_GT(connected_components(by_pairs->graph()).count(), 1u) << seed;
  }
}

TEST(Spectral, GoesOnExactlyInTheMiddleOfManyMembers) {
  test::ToyWorld world = test::long_toy_world(4);
  world.sizes = {30, 45, 0, 25, 20};
  const MergeInput input = make(world, "spectral");
  const auto whole = make_merger(input);
  run(*whole, {});
  ASSERT_GT(whole->state().verifications, 300u);
  for (std::uint64_t k = 0; k <= whole->state().step; k += 17) {
    const auto first = make_merger(input);
    run(*first, stop_at_step(k));
    const auto second = make_merger(input, first->state());
    EXPECT_EQ(second->finished_pairs(), first->finished_pairs()) << k;
    run(*second, {});
    ASSERT_EQ(second->state(), whole->state()) << k;
  }
}

TEST(Spectral, RefusesAStateWhosePartsDoNotFit) {
  const MergeInput input = make(test::long_toy_world(2), "spectral");
  const auto merger = make_merger(input);
  run(*merger, stop_when_merger([](const Merger& m) { return m.state().verifications >= 77; }, StopReason::kPaused));
  const MergeState good = merger->state();
  EXPECT_NO_THROW(make_merger(input, good));
  const auto expect_refused = [&](auto&& damage, const char* what) {
    MergeState state = good;
    damage(state);
    EXPECT_THROW(make_merger(input, state), FormatError) << what;
  };
  expect_refused([](MergeState& s) { s.search.postponed.pop_back(); }, "a candidate is missing");
  expect_refused([](MergeState& s) { std::swap(s.search.postponed[0], s.search.postponed[1]); }, "out of order");
  expect_refused([](MergeState& s) { s.search.pending.back() = s.search.pending.front(); }, "one is there already");
  expect_refused([](MergeState& s) { s.search.pending_next += 1; }, "one has no verdict yet");
  expect_refused([](MergeState& s) { s.search.next_row -= 1; }, "votes are missing");
  expect_refused([](MergeState& s) { s.rejected.back() = s.rejected.front(); }, "a verdict twice");
  expect_refused([](MergeState& s) { s.edges.back().verifications = s.verifications + 1; }, "an edge of the future");
}

}  // namespace
}  // namespace mapweld
