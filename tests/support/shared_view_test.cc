#include "tests/support/shared_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/repeatable.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

const RenderedWorld& world() {
  static const RenderedWorld instance(WorldOptions{.corridor_length_m = 14, .seed = 11});
  return instance;
}

std::vector<Pose> poses_of_two() {
  const TwoRobots robots = two_robots(world(), 90, 70, 11);
  std::vector<Pose> poses = trajectory(world(), robots.a);
  const std::vector<Pose> b = trajectory(world(), robots.b);
  poses.insert(poses.end(), b.begin(), b.end());
  return poses;
}

struct Axes {
  double right[3];
  double down[3];
  double forward[3];
};

Axes axes_of(const Pose& pose) {
  const double radians = 3.14159265358979323846 / 180;
  const double ch = std::cos(pose.heading_deg * radians);
  const double sh = std::sin(pose.heading_deg * radians);
  const double cp = std::cos(pose.pitch_deg * radians);
  const double sp = std::sin(pose.pitch_deg * radians);
  return {{sh, -ch, 0}, {ch * sp, sh * sp, -cp}, {ch * cp, sh * cp, sp}};
}

// Every pixel of a, through its depth into b, where b's depth says whether the point is in sight. Knows nothing of
// surfaces.
double seen_pixel_by_pixel(const Pose& a, const Frame& depth_of_a, const Pose& b, const Frame& depth_of_b) {
  const CameraModel camera = world().options().camera;
  const Axes from = axes_of(a);
  const Axes to = axes_of(b);
  const double at_a[3] = {a.x_m, a.y_m, a.height_m};
  const double at_b[3] = {b.x_m, b.y_m, b.height_m};
  int seen = 0;
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      const double z = depth_of_a.depth_m.at<float>(y, x);
      const double px = (x - (camera.width_px - 1) / 2.0) / camera.focal_px;
      const double py = (y - (camera.height_px - 1) / 2.0) / camera.focal_px;
      double local[3] = {0, 0, 0};
      double same_side = 0;
      for (int k = 0; k < 3; ++k) {
        const double ray = z * (from.forward[k] + px * from.right[k] + py * from.down[k]);
        const double d = at_a[k] + ray - at_b[k];
        same_side += ray * d;
        local[0] += to.right[k] * d;
        local[1] += to.down[k] * d;
        local[2] += to.forward[k] * d;
      }
      if (local[2] < 0.03 || same_side <= 0) continue;
      const int u = static_cast<int>(std::lround(local[0] / local[2] * camera.focal_px + (camera.width_px - 1) / 2.0));
      const int v = static_cast<int>(std::lround(local[1] / local[2] * camera.focal_px + (camera.height_px - 1) / 2.0));
      if (u < 0 || v < 0 || u >= camera.width_px || v >= camera.height_px) continue;
      const cv::Mat& depth = depth_of_b.depth_m;
      const double here = depth.at<float>(v, u);
      // Slanting surfaces change their depth within a pixel; the smaller step to a neighbour stays on the surface.
      const double left = std::abs(here - depth.at<float>(v, std::max(0, u - 1)));
      const double right = std::abs(here - depth.at<float>(v, std::min(camera.width_px - 1, u + 1)));
      const double above = std::abs(here - depth.at<float>(std::max(0, v - 1), u));
      const double below = std::abs(here - depth.at<float>(std::min(camera.height_px - 1, v + 1), u));
      const double slack = 0.004 * here + std::min(left, right) + std::min(above, below);
      seen += std::abs(local[2] - here) < slack;
    }
  }
  return static_cast<double>(seen) / (camera.width_px * camera.height_px);
}

TEST(SharedView, AgreesWithReprojectingEveryPixel) {
  const std::vector<Pose> poses = poses_of_two();
  const std::vector<ViewRecord> records = view_records(world(), poses);
  Random random(1);
  double sum = 0;
  double worst = 0;
  int overlapping = 0;
  int pairs = 0;
  for (int k = 0; k < 4000 && overlapping < 150; ++k) {
    const auto i = static_cast<std::size_t>(random.below(static_cast<int>(poses.size())));
    const auto j = static_cast<std::size_t>(random.below(static_cast<int>(poses.size())));
    const double quick = shared_view(records[i], records[j]);
    if (quick == 0 && k % 40 != 0) continue;  // most pairs share nothing
    const Frame a = world().render_geometry(poses[i]);
    const Frame b = world().render_geometry(poses[j]);
    const double exact =
        std::min(seen_pixel_by_pixel(poses[i], a, poses[j], b), seen_pixel_by_pixel(poses[j], b, poses[i], a));
    overlapping += exact > 0.05;
    ++pairs;
    sum += std::abs(quick - exact);
    worst = std::max(worst, std::abs(quick - exact));
    EXPECT_NEAR(quick, exact, 0.09) << i << " and " << j;
  }
  EXPECT_GE(overlapping, 100);
  EXPECT_LT(sum / pairs, 0.025);
}

TEST(SharedView, IsSymmetricAndWholeWithItself) {
  const std::vector<ViewRecord> records = view_records(world(), poses_of_two());
  for (std::size_t i = 0; i < records.size(); i += 7) {
    EXPECT_GT(shared_view(records[i], records[i]), 0.97);
    for (std::size_t j = 0; j < records.size(); j += 3) {
      EXPECT_EQ(shared_view(records[i], records[j]), shared_view(records[j], records[i]));
    }
  }
}

TEST(SharedView, EndsAtWalls) {
  const Area& corridor = world().plan().corridors[0];
  const Area& next = world().plan().corridors[1];
  // Back to back in the same place, and on either side of two rooms, looking the same way.
  const Pose west{.x_m = 6, .y_m = (corridor.y0 + corridor.y1) / 2, .heading_deg = 180};
  const Pose east{.x_m = 6, .y_m = (corridor.y0 + corridor.y1) / 2, .heading_deg = 0};
  const Pose parallel{.x_m = 6, .y_m = (next.y0 + next.y1) / 2, .heading_deg = 0};
  EXPECT_EQ(shared_view(ViewRecord(world(), west), ViewRecord(world(), east)), 0);
  EXPECT_EQ(shared_view(ViewRecord(world(), parallel), ViewRecord(world(), east)), 0);
}

TEST(SharedView, DoesNotCountWhatIsSeenFromOppositeSides) {
  const Area& corridor = world().plan().corridors[0];
  const double y = (corridor.y0 + corridor.y1) / 2;
  const ViewRecord eastwards(world(), {.x_m = 3, .y_m = y, .heading_deg = 0});
  const ViewRecord westwards(world(), {.x_m = 11, .y_m = y, .heading_deg = 180});
  EXPECT_LT(shared_view(eastwards, westwards), 0.05);
}

TEST(SharedPairs, AreThoseOfSharedViewForAnyNumberOfThreads) {
  const std::vector<Pose> poses = poses_of_two();
  const std::vector<ViewRecord> a = view_records(world(), {poses.begin(), poses.begin() + 90}, 2);
  const std::vector<ViewRecord> b = view_records(world(), {poses.begin() + 90, poses.end()});
  const std::vector<SharedPair> one = shared_pairs(a, b, 0.05, 1);
  const std::vector<SharedPair> three = shared_pairs(a, b, 0.05, 3);
  ASSERT_EQ(one.size(), three.size());
  std::size_t expected = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) expected += shared_view(a[i], b[j]) >= 0.05;
  }
  EXPECT_EQ(one.size(), expected);
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].a, three[k].a);
    EXPECT_EQ(one[k].b, three[k].b);
    EXPECT_EQ(one[k].shared, three[k].shared);
    EXPECT_EQ(one[k].shared, shared_view(a[static_cast<std::size_t>(one[k].a)], b[static_cast<std::size_t>(one[k].b)]));
  }
}

}  // namespace
}  // namespace mapweld::rendered
