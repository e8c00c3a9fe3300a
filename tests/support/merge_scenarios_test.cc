#include "tests/support/merge_scenarios.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

namespace mapweld::rendered {
namespace {

MadeMerge scenario(std::string_view name, std::uint64_t seed) {
  static const auto vocabulary = shipped_vocabulary();
  return make_scenario(name, seed, *vocabulary, 2);
}

TEST(MergeScenarios, EachHasItsName) {
  std::set<std::string_view> names;
  for (const MergeScenario& scenario : merge_scenarios()) {
    EXPECT_TRUE(names.insert(scenario.name).second) << scenario.name;
    EXPECT_FALSE(scenario.what.empty()) << scenario.name;
  }
  for (const char* name : {"storeys", "worn-storeys", "worn-storeys-apart", "worn-look-alike", "filmed-room"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
  EXPECT_THROW(scenario("no such thing", 1), std::invalid_argument);
}

// The same drives, and fewer edges: wear takes from what storeys share.
TEST(MergeScenarios, WornStoreysAreStoreysThatAgreeLess) {
  const MadeMerge as_new = scenario("storeys-apart", 402);
  const MadeMerge worn = scenario("worn-storeys-apart", 402);
  EXPECT_LT(worn.inter_edges.size(), as_new.inter_edges.size());
  EXPECT_GT(worn.inter_edges.size(), 20U);
  EXPECT_EQ(std::ranges::max(worn.shared), 0);
}

TEST(MergeScenarios, EveryImageOfTheFilmIsKept) {
  const MadeMerge filmed = scenario("filmed-room", 402);
  for (const MadeMap* map : {&filmed.a, &filmed.b}) {
    EXPECT_EQ(map->vertices.size(), 90U);
    EXPECT_GT(map->inner_edges.size(), 500U);
  }
  EXPECT_GT(filmed.inter_edges.size(), 100U);
}

}  // namespace
}  // namespace mapweld::rendered
