#include "core/merge/alias_guard.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/merge/guard_world.h"

namespace mapweld {
namespace {

using test::GuardWorld;
using ::testing::Each;
using ::testing::ElementsAre;

TEST(AliasGuard, NothingIsConfirmedOfNothing) {
  const GuardWorld world({5, 5});
  EXPECT_TRUE(world.verdicts().empty());
}

TEST(AliasGuard, TwoDrivesAlongOnePlaceAreConfirmed) {
  GuardWorld world({30, 30});
  world.join_drives(world.at(0, 10), world.at(1, 5), 12, 60);
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
}

TEST(AliasGuard, TravelTheOtherWayIsNoContradiction) {
  GuardWorld world({30, 30});
  for (std::uint32_t i = 0; i < 12; ++i) world.join(world.at(0, 5 + i), world.at(1, 25 - i));
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
}

TEST(AliasGuard, ASingleTrueCrossingNeedsNoNeighbours) {
  GuardWorld world({30, 30});
  world.join(world.at(0, 12), world.at(1, 20));
  EXPECT_THAT(world.reasons(), ElementsAre(Reason::kNone));
}

TEST(AliasGuard, OneThingInTwoOtherwiseDifferentPlacesIsUnsupported) {
  // Seven of a hundred features match: a poster; the other 93 lie in the common view and find no partner.
  GuardWorld world({30, 30});
  world.join(world.at(0, 12), world.at(1, 20), 0, 7);
  EXPECT_THAT(world.reasons(), ElementsAre(Reason::kUnsupported));
}

TEST(AliasGuard, AViewThatIsACornerOfAnotherIsUnsupported) {
  // All features of one image match, within a tenth of the other's width and height: seen from afar.
  GuardWorld world({30, 30});
  world.join(world.at(0, 12), world.at(1, 20), 0, 60);
  auto edges = world.edges();
  // Features are sorted by word; the first word has the lowest number. Take those of the corner for the second image.
  std::vector<std::uint16_t> corner;
  for (std::uint16_t f = 0; f < 100; ++f) {
    const std::uint32_t place = f * 37u % 100;
    if (place % 10 < 3 && place / 10 < 3) corner.push_back(f);
  }
  edges[0].verification.inlier_matches.clear();
  for (const std::uint16_t f : corner) {
    // place (x, y) in the corner of v is place (3x, 3y) of u.
    const std::uint32_t place = f * 37u % 100;
    const std::uint32_t wide = place / 10 * 30 + place % 10 * 3;
    for (std::uint16_t g = 0; g < 100; ++g) {
      if (g * 37u % 100 == wide) edges[0].verification.inlier_matches.emplace_back(g, f);
    }
  }
  const auto verdicts = world.verdicts(edges);
  EXPECT_LT(verdicts[0].evidence.shared_view, 0.2);
  EXPECT_EQ(verdicts[0].reason, Reason::kUnsupported);
}

TEST(AliasGuard, SignificanceThatChanceReachesInAMergeIsUnsupported) {
  GuardWorld world({30, 30});
  world.join(world.at(0, 12), world.at(1, 20));
  world.last_edge().verification.log10_false_alarms = -7;
  EXPECT_THAT(world.reasons(), ElementsAre(Reason::kUnsupported));
}

// b drives along the images of a from 10 on; those from 100 on look like them. `right` and `alike`: matches at every
// other image; at those between them they are exchanged when `mixed`.
GuardWorld look_alike_places(std::uint16_t right, std::uint16_t alike, bool mixed = false, std::uint32_t images = 12) {
  GuardWorld world({170, 70});
  for (std::uint32_t i = 0; i < images; ++i) {
    const bool exchanged = mixed && i % 2 == 1;
    world.join_drives(world.at(0, 10 + i), world.at(1, 5 + i), 1, exchanged ? alike : right);
    world.join_drives(world.at(0, 100 + i), world.at(1, 5 + i), 1, exchanged ? right : alike);
  }
  return world;
}
std::vector<Reason> at_right_place(const GuardWorld& world) {
  const auto all = world.reasons();
  std::vector<Reason> reasons;
  for (std::size_t i = 0; i < all.size(); i += 2) reasons.push_back(all[i]);
  return reasons;
}
std::vector<Reason> at_alike_place(const GuardWorld& world) {
  const auto all = world.reasons();
  std::vector<Reason> reasons;
  for (std::size_t i = 1; i < all.size(); i += 2) reasons.push_back(all[i]);
  return reasons;
}

TEST(AliasGuard, OfTwoPlacesTheBetterSupportedOneIsConfirmed) {
  const GuardWorld world = look_alike_places(80, 30);
  EXPECT_THAT(at_right_place(world), Each(Reason::kNone));
  EXPECT_THAT(at_alike_place(world), Each(Reason::kUnsupported));
}

TEST(AliasGuard, OfTwoPlacesTheOneThatIsBetterAlmostEverywhereIsConfirmed) {
  // Hardly better, but at each of twelve images: a coin would do that once in four thousand times.
  const GuardWorld world = look_alike_places(62, 60);
  EXPECT_THAT(at_right_place(world), Each(Reason::kNone));
  EXPECT_THAT(at_alike_place(world), Each(Reason::kUnsupported));
}

TEST(AliasGuard, TwoPlacesAlikeAreBothAmbiguous) {
  EXPECT_THAT(look_alike_places(62, 60, true).reasons(), Each(Reason::kAmbiguous));
}

TEST(AliasGuard, ASecondPassThatSeesTheFirstAsFullyAsItsOwnNeighboursIsAtOnePlace) {
  GuardWorld world = look_alike_places(62, 60, true, 60);
  for (std::uint32_t i = 0; i < 60; ++i) world.link(world.at(0, 10 + i), world.at(0, 100 + i), 60);
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
}

TEST(AliasGuard, APassThatFallsShortHereAndThereIsNot) {
  // In look-alike corridors the map itself has links from one to the other.
  GuardWorld world = look_alike_places(62, 60, true, 60);
  for (std::uint32_t i = 0; i < 60; ++i) {
    world.link(world.at(0, 10 + i), world.at(0, 100 + i), i % 8 == 7 ? 20 : 60);
  }
  EXPECT_THAT(world.reasons(), Each(Reason::kAmbiguous));
}

TEST(AliasGuard, AFewImagesThatAreLinkedMakeNoRevisit) {
  GuardWorld world = look_alike_places(62, 60, true);
  for (std::uint32_t i = 0; i < 12; ++i) world.link(world.at(0, 10 + i), world.at(0, 100 + i), 60);
  EXPECT_THAT(world.reasons(), Each(Reason::kAmbiguous));
}

TEST(AliasGuard, TheUncontestedPartOfALookAlikePlaceFallsWithTheRest) {
  // The right place is seen from the fourth image on only: a door was shut when a came by.
  GuardWorld world({100, 30});
  world.join_drives(world.at(0, 13), world.at(1, 8), 9, 90);
  world.join_drives(world.at(0, 60), world.at(1, 5), 12, 40);
  const auto reasons = world.reasons();
  EXPECT_THAT(std::vector(reasons.begin(), reasons.begin() + 9), Each(Reason::kNone));
  EXPECT_THAT(std::vector(reasons.begin() + 9, reasons.end()), Each(Reason::kUnsupported));
}

TEST(AliasGuard, AShortWayIntoARoomAndBackIsNoContradiction) {
  // b looks into a room between images 10 and 25, and the two are linked; a drives straight on.
  GuardWorld world({40, 40});
  world.link(world.at(1, 10), world.at(1, 25), 40);
  world.join(world.at(0, 10), world.at(1, 10));
  world.join(world.at(0, 11), world.at(1, 25));
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
}

TEST(AliasGuard, ManyEdgesNoneOfWhichShowsThePlaceAreUnsupported) {
  GuardWorld world({30, 30});
  world.join_drives(world.at(0, 10), world.at(1, 5), 12, 25);
  EXPECT_THAT(world.reasons(), Each(Reason::kUnsupported));
}

TEST(AliasGuard, OneFullEdgeAlongALongDriveShowsAThingAndNotAPlace) {
  GuardWorld world({30, 30});
  world.join_drives(world.at(0, 10), world.at(1, 5), 12, 25);
  world.join(world.at(0, 22), world.at(1, 17), 40, 95);  // full, but short of what needs no company
  EXPECT_THAT(world.reasons(), Each(Reason::kUnsupported));
  world.join_drives(world.at(0, 5), world.at(1, 0), 5, 50);  // and more of them before
  world.join_drives(world.at(0, 23), world.at(1, 18), 3, 50);
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
}

TEST(AliasGuard, AnEdgeThatLeadsElsewhereThanThoseBesideItIsDroppedFromItsCluster) {
  // From the 20th image of a the corridor is in view up to the 45th: one weak link, and both are of one cluster.
  GuardWorld world({60, 40});
  world.join_drives(world.at(0, 14), world.at(1, 14), 12, 60);
  world.link(world.at(0, 20), world.at(0, 45), 10);
  world.join(world.at(0, 45), world.at(1, 20), 0, 60);
  auto reasons = world.reasons();
  EXPECT_EQ(reasons.back(), Reason::kUnsupported);
  reasons.pop_back();
  EXPECT_THAT(reasons, Each(Reason::kNone));
  EXPECT_EQ(world.verdicts().back().evidence.cluster_edges, 13u);
}

TEST(AliasGuard, AnEdgeOverAStrongLinkIsNot) {
  GuardWorld world({60, 40});
  world.join_drives(world.at(0, 14), world.at(1, 14), 12, 60);
  world.link(world.at(0, 20), world.at(0, 45), 40);  // both see the place as they see each other
  world.join(world.at(0, 45), world.at(1, 20), 0, 60);
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
}

TEST(AliasGuard, AWeakEdgeIsConfirmedOnlyWhereAnImageHasNoFullerOne) {
  GuardWorld world({30, 30});
  world.join_drives(world.at(0, 10), world.at(1, 10), 8, 70);
  world.join(world.at(0, 12), world.at(1, 11), 0, 20);  // beside fuller ones of either image
  world.join(world.at(0, 18), world.at(1, 17), 0, 20);  // all that image 18 has
  world.join(world.at(0, 9), world.at(1, 10), 0, 15);   // all that image 9 has, but too little of the view
  EXPECT_THAT(world.reasons(),
              ElementsAre(Reason::kNone, Reason::kNone, Reason::kNone, Reason::kNone, Reason::kNone, Reason::kNone,
                          Reason::kNone, Reason::kNone, Reason::kUnsupported, Reason::kNone, Reason::kUnsupported));
}

TEST(AliasGuard, WordsThatAreEverywhereShowNothing) {
  GuardWorld world({40, 40});
  world.join(world.at(0, 5), world.at(1, 5), 0, 60);
  const std::uint32_t first = 1000 * (world.at(0, 5) + 1);
  for (std::uint32_t f = 0; f < 60; ++f) world.set_word(world.at(0, 35), f, first + f);
  EXPECT_THAT(world.reasons(), ElementsAre(Reason::kUnsupported));
}

TEST(AliasGuard, MembersAreJudgedPairByPair) {
  // c looks like a place of a and like a place of b: those are different maps, and no contradiction.
  GuardWorld world({30, 30, 30});
  world.join_drives(world.at(0, 5), world.at(1, 5), 10, 60);
  world.join_drives(world.at(0, 20), world.at(2, 5), 10, 60);
  world.join_drives(world.at(1, 15), world.at(2, 5), 10, 60);
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
}

TEST(AliasGuard, RareAreTheWordsThatOccurNowhereElse) {
  GuardWorld world({40, 10});
  world.join(world.at(0, 5), world.at(1, 5), 0, 60);
  const std::uint32_t first = 1000 * (world.at(0, 5) + 1);
  for (std::uint32_t f = 0; f < 25; ++f) world.set_word(world.at(0, 35), f, first + f);  // far away
  for (std::uint32_t f = 25; f < 50; ++f) world.set_word(world.at(0, 6), f, first + f);  // beside it
  EXPECT_EQ(world.verdicts()[0].evidence.rare_matches, 35);
}

TEST(AliasGuard, APeakNearbyDoesNotHelpWhatHasNoWordOfItsOwn) {
  GuardWorld world({40, 40});
  world.join(world.at(0, 10), world.at(1, 10), 0, 60);
  world.join(world.at(0, 13), world.at(1, 13), 0, 60);  // two hops on: another cluster, supported by the first
  EXPECT_THAT(world.reasons(), Each(Reason::kNone));
  for (std::uint32_t f = 0; f < 60; ++f) {
    world.set_word(world.at(0, 35), f, 1000 * (world.at(0, 13) + 1) + f);
  }
  EXPECT_THAT(world.reasons(), ElementsAre(Reason::kNone, Reason::kUnsupported));
}

TEST(AliasGuard, AnEdgeInsideAMemberIsRefused) {
  GuardWorld world({10, 10});
  world.join(world.at(0, 1), world.at(0, 8));
  EXPECT_THROW(world.verdicts(), std::invalid_argument);
}

// A world of all kinds at once, at random.
GuardWorld random_world(std::uint64_t seed) {
  GuardWorld world({60, 40, 25});
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  std::set<std::pair<std::uint32_t, std::uint32_t>> taken;
  const std::uint32_t sizes[] = {60, 40, 25};
  for (int drive = 0; drive < 14; ++drive) {
    const std::uint32_t m = below(3), n = (m + 1 + below(2)) % 3;
    const std::uint32_t length = 1 + below(10);
    std::uint32_t u = world.at(m, below(sizes[m] - length)), v = world.at(n, below(sizes[n] - length));
    if (u > v) std::swap(u, v);
    for (std::uint32_t i = 0; i < length; ++i) {
      if (!taken.insert({u + i, v + i}).second) continue;
      world.join(u + i, v + i, static_cast<std::uint16_t>(95 - below(70)), 100);
      world.last_edge().verification.log10_false_alarms = -static_cast<double>(below(60)) - 6;
    }
  }
  for (std::uint32_t v = 0; v < 125; ++v) {
    for (std::uint32_t f = 0; f < 90; ++f) world.set_word(v, f, 1000 * (1 + v % 20) + f);
  }
  return world;
}

TEST(AliasGuard, TheOrderOfTheEdgesDoesNotMatter) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const GuardWorld world = random_world(seed);
    const auto expected = world.verdicts();
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
}

TEST(AliasGuard, WhatWasAskedBeforeDoesNotMatter) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const GuardWorld world = random_world(seed);
    AliasGuard guard = world.guard();
    for (std::size_t n = 0; n <= world.edges().size(); n += 7) {
      const std::vector<MergeEdge> so_far(world.edges().begin(),
                                          world.edges().begin() + static_cast<std::ptrdiff_t>(n));
      ASSERT_EQ(guard.verdicts(so_far), world.verdicts(so_far)) << "seed " << seed;
    }
  }
}

TEST(AliasGuard, TheOrderOfTheMembersDoesNotMatter) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    GuardWorld world({60, 40});
    std::mt19937_64 random(seed);
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    std::set<std::pair<std::uint32_t, std::uint32_t>> taken;
    for (int k = 0; k < 60; ++k) {
      const std::uint32_t u = world.at(0, below(60)), v = world.at(1, below(40));
      if (taken.insert({u, v}).second) world.join(u, v, 0, static_cast<std::uint16_t>(6 + below(60)));
    }
    for (int word = 0; word < 300; ++word) world.set_word(below(100), below(100), 1000 * (1 + below(100)) + below(100));
    EXPECT_EQ(world.exchanged().verdicts(), world.verdicts()) << "seed " << seed;
  }
}

TEST(AliasGuard, RandomWorldsHaveEveryVerdict) {
  std::map<Reason, int> counts;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const Reason reason : random_world(seed).reasons()) ++counts[reason];
  }
  EXPECT_GT(counts[Reason::kNone], 0);
  EXPECT_GT(counts[Reason::kUnsupported], 0);
  EXPECT_GT(counts[Reason::kAmbiguous], 0);
}

}  // namespace
}  // namespace mapweld
