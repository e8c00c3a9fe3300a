#include "core/guard/alias_guard.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/guard/guard_world.h"
#include "tests/support/thread_executor.h"

namespace mapweld {
namespace {

using test::GuardWorld;

std::size_t confirmed(const std::vector<GuardVerdict>& verdicts) {
  return static_cast<std::size_t>(std::ranges::count_if(verdicts, &GuardVerdict::confirmed));
}

TEST(AliasGuard, NothingIsConfirmedOfNothing) { EXPECT_TRUE(GuardWorld({3, 3}).verdicts().empty()); }

TEST(AliasGuard, TwoDrivesAlongOnePlaceAreConfirmed) {
  GuardWorld world({40, 40});
  world.join_drives(world.at(0, 5), world.at(1, 10), 20, 60);
  EXPECT_EQ(confirmed(world.verdicts()), 20u);
}

// The same features, of words that each map has all over: the maps could have told, and say that it is nothing special.
TEST(AliasGuard, WhatEitherMapHasEverywhereShowsNoPlace) {
  GuardWorld world({60, 60});
  for (std::uint32_t i = 0; i < 60; ++i) {
    for (std::size_t f = 0; f < 100; ++f) world.set_word(world.at(1, i), f, static_cast<std::uint32_t>(f));
  }
  for (std::uint32_t i = 0; i < 6; ++i) world.join(world.at(0, 5 + 8 * i), world.at(1, 10 + 8 * i), 0, 25);
  for (const GuardVerdict& v : world.verdicts()) {
    EXPECT_FALSE(v.confirmed());
    EXPECT_EQ(v.reason, Reason::kUnsupported);
    EXPECT_EQ(v.evidence.signs.rare_matches, 0);
  }
}

TEST(AliasGuard, OneWordIsTwoThingsWhereSignaturesSaySo) {
  GuardWorld same({60, 60}), different({60, 60});
  for (GuardWorld* world : {&same, &different}) {
    for (std::uint32_t i = 0; i < 60; ++i) {
      for (std::size_t f = 0; f < 100; ++f) {
        world->set_word(world->at(1, i), f, static_cast<std::uint32_t>(f));
        const std::uint32_t mark = world == &different && i == 10 ? 3 : 1;  // one bit more
        world->set_signature(world->at(1, i), f, {{mark, i == 10 ? 0xFFFFFFFFu : 0u, 0, 0}});
      }
    }
    world->join(world->at(0, 5), world->at(1, 10));
  }
  EXPECT_EQ(same.verdicts()[0].evidence.signs.rare_matches, 0) << "32 bits apart is the same thing";
  EXPECT_EQ(different.verdicts()[0].evidence.signs.rare_matches, 60);
}

// Two drives of one street: what an image has nowhere else in its own map, the other map has where the same place is,
// and that is no reason to think it common.
TEST(AliasGuard, WhatIsRareIsSoInItsOwnMap) {
  GuardWorld world({60, 60});
  for (std::uint32_t i = 0; i < 60; ++i) {
    for (std::size_t f = 0; f < 100; ++f) {
      world.set_word(world.at(1, i), f, static_cast<std::uint32_t>(1000 * (world.at(0, i) + 1) + f));
    }
  }
  world.join(world.at(0, 20), world.at(1, 20));
  const EdgeSigns signs = world.verdicts()[0].evidence.signs;
  EXPECT_EQ(signs.rare_matches, 60);
  EXPECT_EQ(signs.common_share, 0);
  EXPECT_EQ(signs.far_images, 60u - 9u) << "of one map: all but the image, its links, and theirs";
}

// Three images a map: nothing is far enough to test rarity, and what is left must do.
TEST(AliasGuard, RaritySaysNothingWhereNoImageIsFar) {
  GuardWorld world({3, 3});
  world.join(world.at(0, 1), world.at(1, 1), 0, 40);
  const GuardVerdict verdict = world.verdicts()[0];
  EXPECT_EQ(verdict.evidence.signs.far_images, 0u);
  EXPECT_EQ(verdict.evidence.parts.rarity, 0);
}

TEST(AliasGuard, WhereMapsAreDenseLessThanTheirOwnFullnessSpeaksAgainst) {
  GuardWorld world({40, 40});
  world.join(world.at(0, 5), world.at(1, 5), 0, 20);
  const GuardEvidence evidence = world.verdicts()[0].evidence;
  EXPECT_LT(evidence.signs.fullness, evidence.signs.inner_fullness);
  EXPECT_LT(evidence.parts.shortfall, 0);
}

TEST(AliasGuard, AnEdgeBesideAFullOneIsBelievedNearlyAsMuch) {
  GuardWorld lone({40, 40}), beside({40, 40});
  for (GuardWorld* world : {&lone, &beside}) world->join(world->at(0, 6), world->at(1, 6), 0, 8);
  beside.join(beside.at(0, 5), beside.at(1, 5), 0, 80);
  EXPECT_FALSE(lone.verdicts()[0].confirmed());
  EXPECT_TRUE(beside.verdicts()[0].confirmed());
  GuardWorld elsewhere({40, 40});
  elsewhere.join(elsewhere.at(0, 6), elsewhere.at(1, 6), 0, 8);
  elsewhere.join(elsewhere.at(0, 5), elsewhere.at(1, 30), 0, 80);
  EXPECT_FALSE(elsewhere.verdicts()[0].confirmed());
}

TEST(AliasGuard, MembersAreJudgedPairByPair) {
  GuardWorld world({30, 30, 30});
  world.join_drives(world.at(0, 5), world.at(1, 5), 10, 60);
  const auto alone = world.verdicts();
  world.join_drives(world.at(1, 5), world.at(2, 15), 10, 60);
  const auto both = world.verdicts();
  EXPECT_TRUE(std::equal(alone.begin(), alone.end(), both.begin()));
  EXPECT_EQ(confirmed(both), 20u);
}

TEST(AliasGuard, AnEdgeInsideAMemberIsRefused) {
  GuardWorld world({5, 5});
  world.join(world.at(0, 0), world.at(0, 3));
  EXPECT_THROW(world.verdicts(), std::invalid_argument);
}

TEST(AliasGuard, MatchesBeyondAnImageAreRefused) {
  GuardWorld world({5, 5});
  world.join(world.at(0, 0), world.at(1, 3), 90, 101);
  EXPECT_THROW(world.verdicts(), std::invalid_argument);
}

TEST(AliasGuard, LessConfidenceThanIsAskedForConfirmsMore) {
  GuardWorld world({60, 40});
  for (std::uint16_t n = 0; n < 30; ++n)
    world.join(world.at(0, 2 * n), world.at(1, n), 0, static_cast<std::uint16_t>(8 + n));
  std::size_t before = world.edges().size();
  for (const double least : {0.0, 0.5, 0.9, 0.99, 1.0}) {
    world.options.min_confidence = least;
    const auto verdicts = world.verdicts();
    for (const GuardVerdict& v : verdicts) EXPECT_EQ(v.confirmed(), v.confidence >= least);
    EXPECT_LE(confirmed(verdicts), before);
    before = confirmed(verdicts);
  }
}

// Drives that cross here and there, with words that occur in many images.
GuardWorld random_world(std::uint64_t seed) {
  GuardWorld world({60, 40});
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  std::set<std::pair<std::uint32_t, std::uint32_t>> taken;
  const auto join = [&](std::uint32_t u, std::uint32_t v, std::uint16_t matches) {
    if (u < 60 && v < 40 && taken.insert({u, v}).second) world.join(world.at(0, u), world.at(1, v), 0, matches);
  };
  for (int drive = 0; drive < 4; ++drive) {
    const std::uint32_t u = below(50), v = below(30), n = 2 + below(8);
    for (std::uint32_t i = 0; i < n; ++i) join(u + i, v + i, static_cast<std::uint16_t>(8 + below(60)));
  }
  for (int lone = 0; lone < 20; ++lone) join(below(60), below(40), static_cast<std::uint16_t>(8 + below(40)));
  for (int word = 0; word < 3000; ++word) world.set_word(below(100), below(100), below(300));
  return world;
}

TEST(AliasGuard, TheOrderOfTheEdgesDoesNotMatter) {
  std::size_t all = 0, stand = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const GuardWorld world = random_world(seed);
    const auto expected = world.verdicts();
    all += expected.size();
    stand += confirmed(expected);
    std::vector<std::size_t> order(world.edges().size());
    std::iota(order.begin(), order.end(), 0u);
    std::mt19937_64 random(seed);
    for (int shuffle = 0; shuffle < 5; ++shuffle) {
      std::ranges::shuffle(order, random);
      std::vector<MergeEdge> edges;
      for (const std::size_t i : order) edges.push_back(world.edges()[i]);
      const auto verdicts = world.verdicts(edges);
      for (std::size_t k = 0; k < order.size(); ++k) ASSERT_EQ(verdicts[k], expected[order[k]]) << "seed " << seed;
    }
  }
  EXPECT_GT(stand, all / 10);
  EXPECT_LT(stand, all - all / 10);
}

TEST(AliasGuard, WhatWasAskedBeforeDoesNotMatter) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const GuardWorld world = random_world(seed);
    AliasGuard guard = world.guard();
    for (std::size_t n = 0; n <= world.edges().size(); n += 3) {
      const std::vector<MergeEdge> so_far(world.edges().begin(),
                                          world.edges().begin() + static_cast<std::ptrdiff_t>(n));
      ASSERT_EQ(guard.verdicts(so_far), world.verdicts(so_far)) << "seed " << seed;
    }
    const std::vector<MergeEdge> others(world.edges().begin() + 4, world.edges().end());
    ASSERT_EQ(guard.verdicts(others), world.verdicts(others)) << "edges may also be others than before";
  }
}

TEST(AliasGuard, ConfidencesOnlyGrowAsEdgesCome) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const GuardWorld world = random_world(seed);
    std::vector<MergeEdge> edges = world.edges();
    std::mt19937_64 random(seed);
    std::ranges::shuffle(edges, random);
    std::vector<GuardVerdict> before;
    for (std::size_t n = 1; n <= edges.size(); ++n) {
      const auto now = world.verdicts({edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(n)});
      for (std::size_t e = 0; e < before.size(); ++e) ASSERT_GE(now[e].confidence, before[e].confidence);
      before = now;
    }
  }
}

TEST(AliasGuard, TheOrderOfTheMembersDoesNotMatter) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const GuardWorld world = random_world(seed);
    EXPECT_EQ(world.exchanged().verdicts(), world.verdicts()) << "seed " << seed;
  }
}

TEST(AliasGuard, SaysTheSameWithSeveralThreads) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    GuardWorld world({150, 70, 90});
    for (std::uint32_t v = 0; v < 310; ++v) {
      for (std::size_t f = 0; f < 100; f += 2) world.set_word(v, f, random() % 400);
    }
    for (int k = 0; k < 60; ++k) {
      world.join(world.at(0, random() % 150), world.at(1, random() % 70), static_cast<std::uint16_t>(random() % 50));
    }
    const test::ThreadExecutor executor;
    AliasGuard serial = world.guard(), parallel = world.guard(&executor);
    EXPECT_GT(executor.pieces(), 3u);
    EXPECT_TRUE(serial.inner_verdicts() == parallel.inner_verdicts());
    EXPECT_TRUE(serial.verdicts(world.edges()) == parallel.verdicts(world.edges()));
  }
}

TEST(AliasGuard, WhatOneThreadThrowsComesOut) {
  GuardWorld world({5, 5});
  world.link(world.at(1, 0), world.at(1, 4), 101);  // matches beyond its features
  const test::ThreadExecutor executor;
  EXPECT_THROW(world.guard(&executor), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld
