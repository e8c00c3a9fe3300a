#include "tests/support/trajectory.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/rendering/repeatable.h"
#include "tests/support/sample_maps.h"
#include "tests/support/shared_view.h"

namespace mapweld::rendered {
namespace {

double apart_m(const Pose& a, const Pose& b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }
double turned_deg(const Pose& a, const Pose& b) { return std::abs(signed_deg(a.heading_deg - b.heading_deg)); }

TEST(Trajectory, GoesInStepsThroughFreeSpace) {
  for (const int corridors : {1, 2, 3}) {
    const RenderedWorld world(WorldOptions{.corridors = corridors, .corridor_length_m = 13, .seed = 21});
    const std::vector<Pose> poses = trajectory(world, {.n_images = 400, .seed = 2});
    ASSERT_EQ(poses.size(), 400U);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_TRUE(world.is_free(poses[i], 0.1)) << corridors << " corridors, image " << i;
      if (i == 0) continue;
      EXPECT_LT(apart_m(poses[i], poses[i - 1]), 0.65) << i;
      EXPECT_LT(turned_deg(poses[i], poses[i - 1]), 30) << i;
      EXPECT_GT(apart_m(poses[i], poses[i - 1]) + turned_deg(poses[i], poses[i - 1]) / 60, 0.05) << i;
    }
  }
}

TEST(Trajectory, NeighboursShareTheirView) {
  const RenderedWorld world(WorldOptions{.seed = 22});
  const std::vector<ViewRecord> records = view_records(world, trajectory(world, {.n_images = 300, .seed = 3}));
  std::vector<double> next;
  for (std::size_t i = 1; i < records.size(); ++i) next.push_back(shared_view(records[i - 1], records[i]));
  std::sort(next.begin(), next.end());
  EXPECT_GT(next[next.size() / 2], 0.45);
  EXPECT_GT(next[next.size() / 20], 0.2);
}

TEST(Trajectory, IsTheSameFromTheSameSeed) {
  const RenderedWorld world(WorldOptions{.seed = 23});
  EXPECT_EQ(trajectory(world, {.n_images = 50, .seed = 4}), trajectory(world, {.n_images = 50, .seed = 4}));
  EXPECT_NE(trajectory(world, {.n_images = 50, .seed = 4}), trajectory(world, {.n_images = 50, .seed = 5}));
}

TEST(Trajectory, TurnsBackTheOtherWayRound) {
  const RenderedWorld world(WorldOptions{.seed = 24});
  const std::vector<Pose> poses = trajectory(world, {.n_images = 120, .turn_back_after = 0.5});
  // Ten images after the turn it stands near where it stood before, and looks the other way.
  const int turns = 10;
  for (int k = turns + 2; k < 50; k += 5) {
    const Pose& back = poses[static_cast<std::size_t>(60 + k)];
    bool found = false;
    for (int i = 0; i < 60; ++i) {
      const Pose& out = poses[static_cast<std::size_t>(i)];
      found |= apart_m(out, back) < 0.35 && turned_deg(out, back) > 165;
    }
    EXPECT_TRUE(found) << k;
  }
}

TEST(Trajectory, RefusesNoSteps) {
  const RenderedWorld world(WorldOptions{.corridor_length_m = 12});
  EXPECT_THROW(trajectory(world, {.n_images = -1}), std::invalid_argument);
  EXPECT_THROW(trajectory(world, {.step_m = 0}), std::invalid_argument);
  EXPECT_THROW(trajectory(world, {.turn_deg = 0}), std::invalid_argument);
}

TEST(TwoRobots, OverlapInPart) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const RenderedWorld world(world_for_maps(150, 100, seed));
    const TwoRobots robots = two_robots(world, 150, 100, seed);
    const std::vector<ViewRecord> a = view_records(world, trajectory(world, robots.a));
    const std::vector<ViewRecord> b = view_records(world, trajectory(world, robots.b));
    std::vector<bool> met(b.size());
    for (const SharedPair& pair : shared_pairs(a, b, 0.4)) met[static_cast<std::size_t>(pair.b)] = true;
    const auto count = std::count(met.begin(), met.end(), true);
    EXPECT_GT(count, 25) << "seed " << seed;
    EXPECT_LT(count, 90) << "seed " << seed;
  }
}

TEST(QueryPoses, LieOffTheDrivesInFreeSpace) {
  const RenderedWorld world(WorldOptions{.seed = 25});
  const std::vector<Pose> driven = trajectory(world, {.n_images = 150});
  const std::vector<Pose> queries = query_poses(world, driven, 40, 9);
  ASSERT_EQ(queries.size(), 40U);
  const std::vector<ViewRecord> map = view_records(world, driven);
  const std::vector<ViewRecord> seen = view_records(world, queries);
  int known = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    EXPECT_TRUE(world.is_free(queries[i], 0.2));
    double best = 0;
    for (const ViewRecord& record : map) best = std::max(best, shared_view(seen[i], record));
    known += best > 0.4;
    EXPECT_EQ(std::count(driven.begin(), driven.end(), queries[i]), 0);
  }
  EXPECT_GE(known, 30);
}

TEST(SampleMaps, AreMadeOncePerProcess) {
  const SampleMaps& maps = small_world_pair(6, 4, 2);
  EXPECT_EQ(&maps, &small_world_pair(6, 4, 2));
  EXPECT_EQ(maps.a.jpegs.size(), 6U);
  EXPECT_EQ(maps.b.views.size(), 4U);
  EXPECT_EQ(maps.queries.poses.size(), 2U);
  SampleMapsOptions options;
  options.n_images_a = 6;
  options.n_images_b = 4;
  options.n_queries = 2;
  options.threads = 2;
  const SampleMaps again = render_sample_maps(options);
  EXPECT_EQ(again.a.jpegs, maps.a.jpegs);
  EXPECT_EQ(again.b.jpegs, maps.b.jpegs);
  EXPECT_EQ(again.queries.jpegs, maps.queries.jpegs);
}

}  // namespace
}  // namespace mapweld::rendered
