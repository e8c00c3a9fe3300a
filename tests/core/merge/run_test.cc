#include "core/merge/run.h"

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

std::unique_ptr<Merger> fresh() { return make_merger(make_toy_merge(test::toy_world(19))); }

TEST(StopCondition, VerificationsAreReachedToTheNumber) {
  for (const std::uint64_t n : {1u, 2u, 7u, 30u}) {
    const auto merger = fresh();
    EXPECT_EQ(run(*merger, stop_at_verifications(n)), StopReason::kVerifications);
    EXPECT_EQ(merger->state().verifications, n);
    EXPECT_EQ(run(*merger, stop_at_verifications(n)), StopReason::kVerifications);  // nothing is left of it
    EXPECT_EQ(merger->state().verifications, n);
    EXPECT_EQ(run(*merger, stop_at_verifications(n + 3)), StopReason::kVerifications);
    EXPECT_EQ(merger->state().verifications, n + 3);
  }
}

TEST(StopCondition, EdgesAreReachedToTheNumber) {
  const auto merger = fresh();
  EXPECT_EQ(run(*merger, stop_at_edges(4)), StopReason::kEdges);
  EXPECT_EQ(merger->state().edges.size(), 4u);
  EXPECT_EQ(merger->state().edges.back().verifications, merger->state().verifications);
}

TEST(StopCondition, FromOutsideIsAskedBeforeEveryStep) {
  const auto merger = fresh();
  int asked = 0;
  EXPECT_EQ(run(*merger, stop_when([&asked] { return ++asked > 5; }, StopReason::kSeconds)), StopReason::kSeconds);
  EXPECT_EQ(merger->state().step, 5u);
}

TEST(StopCondition, OfSeveralTheFirstInOrderIsTold) {
  const auto merger = fresh();
  const StopCondition always = stop_when([] { return true; }, StopReason::kPaused);
  const StopCondition never = stop_when([] { return false; }, StopReason::kSeconds);
  EXPECT_EQ(stop_at_first({})(*merger), std::nullopt);
  EXPECT_EQ(stop_at_first({never, never})(*merger), std::nullopt);
  EXPECT_EQ(stop_at_first({never, always})(*merger), StopReason::kPaused);
  EXPECT_EQ(stop_at_first({stop_at_edges(0), always})(*merger), StopReason::kEdges);
  EXPECT_EQ(run(*merger, stop_at_first({stop_at_edges(1000), stop_at_verifications(6)})), StopReason::kVerifications);
  EXPECT_EQ(merger->state().verifications, 6u);
}

TEST(Run, WithoutAConditionEndsWithTheMerge) {
  const auto merger = fresh();
  std::uint64_t seen = 0;
  EXPECT_EQ(run(*merger, {}, [&seen](const Merger&) { ++seen; }), std::nullopt);
  EXPECT_TRUE(merger->done());
  EXPECT_EQ(seen, merger->state().step);
}

TEST(Run, OfAFinishedMergeDoesNothing) {
  const auto merger = fresh();
  run(*merger, {});
  const MergeState state = merger->state();
  const StopCondition always = stop_when([] { return true; }, StopReason::kPaused);
  EXPECT_EQ(run(*merger, always), std::nullopt);
  EXPECT_EQ(merger->state(), state);
}

TEST(Run, IsTheSameWhoeverWatchesAndHoweverOftenItStops) {
  const auto whole = fresh();
  run(*whole, {});
  const auto pieces = fresh();
  for (std::uint64_t n = 1; run(*pieces, stop_at_verifications(n)); ++n) continue;
  EXPECT_EQ(pieces->state(), whole->state());
}

}  // namespace
}  // namespace mapweld
