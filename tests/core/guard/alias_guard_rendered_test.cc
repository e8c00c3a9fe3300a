// The alias guard on images: small rendered buildings, the real extractor, vocabulary, mapper and verifier.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/guard/alias_guard.h"
#include "tests/support/rendered_merge.h"
#include "tests/support/sample_maps.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

const Vocabulary& vocabulary() {
  static const auto shipped = shipped_vocabulary();
  return *shipped;
}

WorldOptions one_corridor(std::uint64_t seed) {
  WorldOptions options;
  options.corridors = 1;
  options.corridor_length_m = 8;
  options.seed = seed;
  return options;
}

std::vector<Pose> drive(const RenderedWorld& world, int images, std::uint64_t seed, int storey = 0) {
  TrajectoryOptions options;
  options.n_images = images;
  options.seed = seed;
  options.storey = storey;
  options.enters_room = 0.3;
  return trajectory(world, options);
}

MadeMerge merge_of(const RenderedWorld& a, std::vector<Pose> poses_a, const RenderedWorld& b,
                   std::vector<Pose> poses_b) {
  return make_merge({&a, std::move(poses_a), conditions_of_a(), 1}, {&b, std::move(poses_b), conditions_of_b(), 2},
                    vocabulary(), 2);
}

struct Counts {
  int verified = 0, verified_wrong = 0, confirmed = 0, confirmed_wrong = 0;
};
// Wrong: the two images share less than a tenth of their view.
Counts count(const MadeMerge& merge) {
  const auto verdicts = guard_edges(merge.members(), merge.inner_edges(), merge.inter_edges, merge.appearances());
  Counts counts;
  for (std::size_t e = 0; e < verdicts.size(); ++e) {
    const int wrong = merge.shared[e] < 0.1f ? 1 : 0;
    ++counts.verified;
    counts.verified_wrong += wrong;
    if (!verdicts[e].confirmed()) continue;
    ++counts.confirmed;
    counts.confirmed_wrong += wrong;
  }
  return counts;
}

TEST(AliasGuardRendered, TwoRobotsOnOneFloorAreJoined) {
  const RenderedWorld world(one_corridor(61));
  const MadeMerge merge = merge_of(world, drive(world, 40, 1), world, drive(world, 30, 2));
  const Counts counts = count(merge);
  EXPECT_GT(counts.confirmed, counts.verified / 2);
  // An edge beside right ones may share less than a tenth of the view with them.
  EXPECT_LE(counts.confirmed_wrong, counts.confirmed / 50);
}

TEST(AliasGuardRendered, BuildingsFurnishedFromOneCatalogueAreNotJoined) {
  WorldOptions options = one_corridor(63);
  options.catalogue_seed = 7;
  options.catalogue_posters = 20;
  const RenderedWorld one(options);
  options.seed = 64;
  const RenderedWorld other(options);
  const Counts counts = count(merge_of(one, drive(one, 40, 1), other, drive(other, 40, 2)));
  EXPECT_EQ(counts.confirmed, 0);
}

}  // namespace
}  // namespace mapweld::rendered
