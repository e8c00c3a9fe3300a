#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/repeatable.h"
#include "tests/support/shared_view.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

const RenderedWorld& world() {
  static const RenderedWorld instance(
      WorldOptions{.corridors = 1, .corridor_length_m = 9, .open_rooms = 1, .seed = 24});
  return instance;
}

FilmOptions take(std::uint64_t seed) {
  FilmOptions options;
  options.seed = seed;
  options.room = largest_open_room(world());
  return options;
}

TEST(Film, WalksInOneRoomAndTurnsAbout) {
  const Area room = world().plan().rooms[largest_open_room(world())].area;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const std::vector<Pose> poses = film(world(), take(seed));
    ASSERT_EQ(poses.size(), 90U);
    double turned = 0, walked = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_TRUE(room.contains(poses[i].x_m, poses[i].y_m, 0.15));
      EXPECT_TRUE(world().is_free(poses[i], 0.15)) << "image " << i;
      if (i == 0) continue;
      const double step = std::hypot(poses[i].x_m - poses[i - 1].x_m, poses[i].y_m - poses[i - 1].y_m);
      const double turn = signed_deg(poses[i].heading_deg - poses[i - 1].heading_deg);
      EXPECT_LT(step, 0.06);
      EXPECT_LE(std::abs(turn), 6.001);
      walked += step;
      turned += std::abs(turn);
    }
    EXPECT_GT(walked, 1.5);
    EXPECT_GT(turned, 200);
  }
}

TEST(Film, SuccessiveImagesShareNearlyAllTheySee) {
  const auto records = view_records(world(), film(world(), take(1)));
  for (std::size_t i = 1; i < records.size(); ++i) EXPECT_GT(shared_view(records[i - 1], records[i]), 0.6) << i;
}

TEST(Film, FollowsFromItsOptions) {
  EXPECT_EQ(film(world(), take(1)), film(world(), take(1)));
  EXPECT_NE(film(world(), take(1)), film(world(), take(2)));
}

TEST(Film, NeedsAnOpenRoom) {
  const RenderedWorld closed(WorldOptions{.corridors = 1, .corridor_length_m = 9, .open_rooms = 0});
  EXPECT_THROW(largest_open_room(closed), std::invalid_argument);
  EXPECT_THROW(film(closed, {}), std::invalid_argument);
  EXPECT_THROW(film(world(), {.room = 1000}), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld::rendered
