// run(n) equals run(k), make a merger from the state, run(n - k): for every method, many worlds and many k.
#include <random>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/merge/make_merger.h"
#include "core/merge/methods/quick_connect.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

StopCondition stop_at_step(std::uint64_t step) {
  return stop_when_merger([step](const Merger& m) { return m.state().step >= step; }, StopReason::kPaused);
}

TEST(Resume, GoesOnExactlyWhereTheMergeStopped) {
  std::mt19937 random(1);
  for (const std::string_view method : merge_methods()) {
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      world.method = method;
      const MergeInput input = make_toy_merge(world);
      const auto whole = make_merger(input);
      run(*whole, {});
      const std::uint64_t steps = whole->state().step;
      for (int k = 0; k < 6; ++k) {
        const std::uint64_t pause = steps == 0 ? 0 : random() % (steps + 1);
        const std::uint64_t end = pause + (steps == pause ? 0 : random() % (steps - pause + 1));
        const auto straight = make_merger(input);
        run(*straight, stop_at_step(end));
        const auto first = make_merger(input);
        run(*first, stop_at_step(pause));
        const auto second = make_merger(input, first->state());
        EXPECT_EQ(second->graph().edge_list(), first->graph().edge_list());
        run(*second, stop_at_step(end));
        ASSERT_EQ(second->state(), straight->state()) << method << " seed " << seed << " at " << pause;
        run(*second, {});
        ASSERT_EQ(second->state(), whole->state()) << method << " seed " << seed << " at " << pause;
      }
    }
  }
}

TEST(Resume, AfterEveryStepIsTheSameToo) {
  for (const std::string_view method : merge_methods()) {
    test::ToyWorld world;
    world.method = method;
    const MergeInput input = make_toy_merge(world);
    const auto whole = make_merger(input);
    run(*whole, {});
    auto merger = make_merger(input);
    while (!merger->done()) {
      merger->step();
      merger = make_merger(input, merger->state());
    }
    EXPECT_EQ(merger->state(), whole->state());
  }
}

TEST(Resume, RefusesTheStateOfAnotherMerge) {
  const test::ToyWorld world;
  const auto merger = make_merger(make_toy_merge(world));
  run(*merger, stop_at_step(20));
  const MergeState good = merger->state();
  const auto expect_refused = [&](const test::ToyWorld& other, const char* what) {
    EXPECT_THROW(make_merger(make_toy_merge(other), good), FormatError) << what;
  };
  test::ToyWorld other = world;
  other.method = "brute-force";
  expect_refused(other, "another method");
  other = world;
  other.min_votes += 1;
  expect_refused(other, "other options");
  other = world;
  other.seed += 1;
  expect_refused(other, "other images");
  other = world;
  other.sizes[0] += 1;
  expect_refused(other, "a map that has grown");
  const auto with_verifier = [&](const VerifierOptions& options) {
    MergeInput input = make_toy_merge(world);
    input.verifier = std::make_shared<test::HashVerifier>(world.accept_share, options);
    return make_merger(input, good);
  };
  EXPECT_NO_THROW(with_verifier({}));
  EXPECT_THROW(with_verifier({.min_inliers = 30}), FormatError) << "a verifier that wants more inliers";
  EXPECT_THROW(with_verifier({.max_false_alarms = 1e-6}), FormatError) << "a verifier that takes more false alarms";
}

TEST(Resume, RefusesAStateWhosePartsDoNotFit) {
  const MergeInput input = make_toy_merge(test::toy_world(19));
  const auto merger = make_merger(input);
  run(*merger, stop_when_merger([](const Merger& m) { return m.state().edges.size() >= 3; }, StopReason::kPaused));
  const MergeState good = merger->state();
  EXPECT_NO_THROW(make_merger(input, good));
  const auto expect_refused = [&](auto&& damage) {
    MergeState state = good;
    damage(state);
    EXPECT_THROW(make_merger(input, state), FormatError);
  };
  expect_refused([](MergeState& s) { ++s.verifications; });
  expect_refused([](MergeState& s) {
    s.edges.push_back(s.edges.front());
    ++s.verifications;
  });
  expect_refused([](MergeState& s) { s.edges.front().v = VertexId{9999}; });
  expect_refused([](MergeState& s) { s.search.priorities.pop_back(); });
  expect_refused([](MergeState& s) { ++s.search.words_processed; });
  expect_refused([](MergeState& s) { s.search.pending_next = s.search.pending.size() + 1; });
  expect_refused([](MergeState& s) { s.search.postponed.push_back({VertexId{0}, VertexId{0}, 9}); });
  expect_refused([](MergeState& s) { s.search.similarity = SimilarityMatrix::dense(1, 1); });
}

}  // namespace
}  // namespace mapweld
