#include "core/geometry/pose/relative_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/geometry/two_view_scene.h"
#include "tests/support/true_pose.h"

namespace mapweld {
namespace {

using rendered::angle_deg;
using test::make_scene;
using test::SceneOptions;
using test::TwoViewScene;
using Matches = std::vector<std::pair<std::uint16_t, std::uint16_t>>;

// Those of make_scene.
const Camera kCamera{.fx_px = 280, .fy_px = 280, .cx_px = 159.5, .cy_px = 119.5};

Matches matches_of(const TwoViewScene& scene) { return {scene.true_matches.begin(), scene.true_matches.end()}; }

struct Truth {
  Matrix3 rotation{};
  std::array<double, 3> direction{};
};

// As two_view_scene.h says: first turned to the right, then rolled; the second camera went forward and sideways.
Truth truth_of(const SceneOptions& o) {
  const double pan = o.pan_deg * std::numbers::pi / 180, roll = o.roll_deg * std::numbers::pi / 180;
  const double cp = std::cos(pan), sp = std::sin(pan), cr = std::cos(roll), sr = std::sin(roll);
  Truth truth{.rotation = {cr * cp, -sr, -cr * sp, sr * cp, cr, -sr * sp, sp, 0, cp}};
  const double length = std::hypot(o.forward_m, o.sideways_m);
  for (std::size_t r = 0; r < 3; ++r) {
    truth.direction[r] = -(truth.rotation[3 * r] * o.sideways_m + truth.rotation[3 * r + 2] * o.forward_m) / length;
  }
  return truth;
}

TEST(RelativePose, IsThatOfTheScene) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const SceneOptions options{.seed = seed, .roll_deg = 10};
    const TwoViewScene scene = make_scene(options);
    const auto pose = relative_pose(scene.a, kCamera, scene.b, kCamera, matches_of(scene));
    ASSERT_TRUE(pose && pose->direction) << seed;
    const Truth truth = truth_of(options);
    EXPECT_LT(angle_deg(pose->rotation, truth.rotation), 0.7) << seed;
    EXPECT_LT(angle_deg(*pose->direction, truth.direction), 5) << seed;
    EXPECT_GE(pose->inliers, 75) << seed;
    EXPECT_GT(pose->parallax_deg, 0.5) << seed;
  }
}

TEST(RelativePose, HasBothWaysTheSameCameras) {
  const TwoViewScene scene = make_scene({.seed = 3, .pan_deg = 8});
  Matches back;
  for (const auto& [i, j] : matches_of(scene)) back.emplace_back(j, i);
  const auto there = relative_pose(scene.a, kCamera, scene.b, kCamera, matches_of(scene));
  const auto again = relative_pose(scene.b, kCamera, scene.a, kCamera, back);
  ASSERT_TRUE(there && there->direction && again && again->direction);
  const Matrix3& r = there->rotation;
  EXPECT_LT(angle_deg(again->rotation, {r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}), 0.01);
  std::array<double, 3> returned{};  // -R^T t
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) returned[k] -= r[3 * i + k] * (*there->direction)[i];
  }
  EXPECT_LT(angle_deg(*again->direction, returned), 0.1);
}

TEST(RelativePose, CamerasMayDiffer) {
  const SceneOptions options{.seed = 5, .scale_b = 2};
  const TwoViewScene scene = make_scene(options);
  const Camera twice{.fx_px = 560, .fy_px = 560, .cx_px = 319, .cy_px = 239};
  const auto pose = relative_pose(scene.a, kCamera, scene.b, twice, matches_of(scene));
  ASSERT_TRUE(pose && pose->direction);
  EXPECT_LT(angle_deg(pose->rotation, truth_of(options).rotation), 0.7);
  EXPECT_LT(angle_deg(*pose->direction, truth_of(options).direction), 5);
}

TEST(RelativePose, WrongMatchesAmongTheRightOnesChangeLittle) {
  const SceneOptions options{.seed = 6};
  const TwoViewScene scene = make_scene(options);
  Matches matches = matches_of(scene);
  for (std::uint16_t i = 0; i < 25; ++i) matches.emplace_back(i, static_cast<std::uint16_t>(120 - 3 * i));
  const auto pose = relative_pose(scene.a, kCamera, scene.b, kCamera, matches);
  ASSERT_TRUE(pose && pose->direction);
  EXPECT_LT(angle_deg(pose->rotation, truth_of(options).rotation), 1);
  EXPECT_LT(angle_deg(*pose->direction, truth_of(options).direction), 8);
}

TEST(RelativePose, OfACameraThatOnlyTurnedHasNoDirection) {
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SceneOptions options{.seed = seed, .forward_m = 0, .sideways_m = 0, .pan_deg = 12};
    const TwoViewScene scene = make_scene(options);
    const auto pose = relative_pose(scene.a, kCamera, scene.b, kCamera, matches_of(scene));
    ASSERT_TRUE(pose) << seed;
    told += pose->direction ? 1 : 0;
    EXPECT_LT(angle_deg(pose->rotation, truth_of(options).rotation), 0.2) << seed;
    EXPECT_NEAR(pose->deviation, 1, 0.6) << seed;
  }
  EXPECT_EQ(told, 0);
}

// Two views of a plane have two poses; where both have the points in front, none is told, and never the wrong one.
TEST(RelativePose, OfAPlaneIsRightOrNotTold) {
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const SceneOptions options{.seed = seed, .flat = true, .forward_m = 0.2, .sideways_m = 1.0};
    const TwoViewScene scene = make_scene(options);
    const auto pose = relative_pose(scene.a, kCamera, scene.b, kCamera, matches_of(scene));
    if (!pose || !pose->direction) continue;
    ++told;
    EXPECT_LT(angle_deg(*pose->direction, truth_of(options).direction), 10) << seed;
  }
  RecordProperty("told", told);
}

TEST(RelativePose, OfTooFewMatchesIsNone) {
  const TwoViewScene scene = make_scene({.seed = 2});
  Matches matches = matches_of(scene);
  matches.resize(7);
  EXPECT_FALSE(relative_pose(scene.a, kCamera, scene.b, kCamera, matches));
  EXPECT_FALSE(relative_pose(scene.a, kCamera, scene.b, kCamera, {}));
}

TEST(RelativePose, IsTheSameAgain) {
  const TwoViewScene scene = make_scene({.seed = 8});
  const auto once = relative_pose(scene.a, kCamera, scene.b, kCamera, matches_of(scene));
  const auto again = relative_pose(scene.a, kCamera, scene.b, kCamera, matches_of(scene));
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->rotation, again->rotation);
  EXPECT_EQ(once->direction, again->direction);
}

TEST(RelativePose, MatchesBeyondTheImageAreDamage) {
  const TwoViewScene scene = make_scene({.seed = 2});
  const Matches matches(10, {9999, 0});
  EXPECT_THROW(relative_pose(scene.a, kCamera, scene.b, kCamera, matches), std::out_of_range);
}

}  // namespace
}  // namespace mapweld
