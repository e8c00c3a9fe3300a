#include "core/merge/methods/brute_force.h"

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "tests/core/merge/paper_oracle.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"

namespace mapweld {
namespace {

TEST(BruteForce, TakesTheImagesOfTheSmallerMapInTurn) {
  for (std::uint32_t seed = 0; seed < 120; ++seed) {
    test::ToyWorld world = test::toy_world(seed);
    world.method = "brute-force";
    const MergeInput input = make_toy_merge(world);
    const test::OracleRun expected = test::brute_force_by_the_paper(input);
    const auto merger = make_merger(input);
    EXPECT_EQ(test::log_verdicts(*merger), test::without_votes_of_rejected(expected.verdicts)) << "seed " << seed;
    EXPECT_EQ(merger->state().candidates_known, expected.verdicts.size());
  }
}

TEST(BruteForce, EndsWithTheEdgesOfQuickConnect) {
  std::size_t edges = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    test::ToyWorld world = test::toy_world(seed);
    const auto quick = make_merger(make_toy_merge(world));
    world.method = "brute-force";
    const auto brute = make_merger(make_toy_merge(world));
    run(*quick, {});
    run(*brute, {});
    EXPECT_EQ(test::edge_set(quick->state()), test::edge_set(brute->state())) << "seed " << seed;
    EXPECT_EQ(quick->state().verifications, brute->state().verifications);
    edges += quick->state().edges.size();
  }
  EXPECT_GT(edges, 2000u);
}

}  // namespace
}  // namespace mapweld
