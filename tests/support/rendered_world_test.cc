#include "tests/support/rendered_world.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/support/image_checksum.h"
#include "tests/support/rendering/floor_plan.h"
#include "tests/support/shared_view.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && checksum(a) == checksum(b);
}

// The default world and a drive through it, built once.
const RenderedWorld& world() {
  static const RenderedWorld instance(WorldOptions{.seed = 7});
  return instance;
}
const std::vector<Pose>& drive() {
  static const std::vector<Pose> poses = trajectory(world(), {.n_images = 160, .seed = 7});
  return poses;
}
const Pose& pose_at(std::size_t i) { return drive()[i]; }

CameraConditions without_noise() {
  CameraConditions conditions;
  conditions.noise_sigma = 0;
  conditions.vignetting = 0;
  return conditions;
}

struct Found {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

Found sift(const cv::Mat& bgr) {
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  Found found;
  cv::SIFT::create()->detectAndCompute(grey, {}, found.keypoints, found.descriptors);
  return found;
}

// Matches under the ratio 0.8 that agree on a fundamental matrix.
int inliers(const Found& a, const Found& b) {
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher(cv::NORM_L2).knnMatch(a.descriptors, b.descriptors, nearest, 2);
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  std::set<int> used;
  for (const auto& two : nearest) {
    if (two.size() < 2 || two[0].distance >= 0.8F * two[1].distance || !used.insert(two[0].trainIdx).second) continue;
    from.push_back(a.keypoints[static_cast<std::size_t>(two[0].queryIdx)].pt);
    to.push_back(b.keypoints[static_cast<std::size_t>(two[0].trainIdx)].pt);
  }
  if (from.size() < 8) return 0;
  cv::Mat mask;
  cv::findFundamentalMat(from, to, cv::USAC_DEFAULT, 1.5, 0.99, 2000, mask);
  return mask.empty() ? 0 : cv::countNonZero(mask);
}

TEST(RenderedWorld, IsTheSameFromTheSameOptions) {
  const RenderedWorld again(WorldOptions{.seed = 7});
  for (const std::size_t i : {0U, 31U, 77U}) {
    const Frame a = world().render(pose_at(i));
    const Frame b = again.render(pose_at(i));
    EXPECT_TRUE(same(a.bgr, b.bgr));
    EXPECT_TRUE(same(a.depth_m, b.depth_m));
    EXPECT_TRUE(same(a.surface, b.surface));
  }
  const RenderedWorld other(WorldOptions{.seed = 8});
  EXPECT_FALSE(same(world().render(Pose{.x_m = 5, .y_m = 5.9}).bgr, other.render(Pose{.x_m = 5, .y_m = 5.9}).bgr));
}

TEST(RenderedWorld, IsTheSameOnTwoThreads) {
  std::vector<std::uint64_t> one;
  for (std::size_t i = 0; i < 24; ++i) one.push_back(checksum(world().render(pose_at(i)).bgr));
  std::vector<std::uint64_t> two(one.size());
  {
    const auto half = [&](std::size_t first) {
      for (std::size_t i = first; i < two.size(); i += 2) two[i] = checksum(world().render(pose_at(i)).bgr);
    };
    const std::jthread other(half, std::size_t{1});
    half(0);
  }
  EXPECT_EQ(one, two);
}

// The world is frozen: figures in docs/ are measured on it, and seeds in other tests rely on it. If a change is meant,
// measure docs/rendered-world.md again.
TEST(RenderedWorld, IsFrozen) {
  EXPECT_EQ(checksum(world().render(pose_at(5)).bgr), 11851742043122330714ULL);
  EXPECT_EQ(checksum(world().render(pose_at(60)).bgr), 1694813705279022702ULL);
  CameraConditions dusk;
  dusk.daylight = 0.1;
  dusk.gamma = 1.2;
  dusk.warmth = 0.5;
  dusk.motion_blur_px = 2;
  dusk.noise_seed = 3;
  EXPECT_EQ(checksum(world().render(pose_at(100), dusk).bgr), 14047900508788750550ULL);
}

TEST(RenderedWorld, LeavesNoPixelUnpainted) {
  for (std::size_t i = 0; i < drive().size(); i += 8) {
    const Frame frame = world().render_geometry(pose_at(i));
    double nearest = 0;
    double least = 0;
    cv::minMaxLoc(frame.surface, &least);
    cv::minMaxLoc(frame.depth_m, &nearest);
    EXPECT_GE(least, 0) << "image " << i;
    EXPECT_GT(nearest, 0.05) << "image " << i;
  }
}

TEST(RenderedWorld, IsSeenFromThresholds) {
  const FloorPlan& plan = world().plan();
  int doors = 0;
  for (const Room& room : plan.rooms) {
    if (!room.open) continue;
    ++doors;
    const double wall = room.north ? room.area.y0 - plan.wall_m / 2 : room.area.y1 + plan.wall_m / 2;
    for (const double heading : {0.0, 90.0, 200.0, 270.0}) {
      const Pose pose{.x_m = room.door_x_m, .y_m = wall, .heading_deg = heading};
      double least = 0;
      cv::minMaxLoc(world().render_geometry(pose, 2).surface, &least);
      EXPECT_GE(least, 0) << "heading " << heading;
    }
  }
  EXPECT_GE(doors, 3);
}

TEST(RenderedWorld, GeometryAgreesWithTheImages) {
  const Frame image = world().render(pose_at(40));
  const Frame full = world().render_geometry(pose_at(40), 1);
  const Frame coarse = world().render_geometry(pose_at(40), 4);
  ASSERT_EQ(coarse.surface.size(), cv::Size(80, 60));
  int agree = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (image.surface.at<int>(y, x) != full.surface.at<int>(y, x)) continue;
      ++agree;
      // Where a pixel shows one surface only, both give the depth of its middle.
      EXPECT_NEAR(image.depth_m.at<float>(y, x), full.depth_m.at<float>(y, x), 0.03 * full.depth_m.at<float>(y, x));
    }
  }
  EXPECT_GT(agree, 0.97 * 320 * 240);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      // The middle of the block lies between four pixels.
      const int here = coarse.surface.at<int>(y, x);
      const bool uniform =
          full.surface.at<int>(4 * y + 1, 4 * x + 1) == here && full.surface.at<int>(4 * y + 2, 4 * x + 2) == here &&
          full.surface.at<int>(4 * y + 1, 4 * x + 2) == here && full.surface.at<int>(4 * y + 2, 4 * x + 1) == here;
      if (!uniform) continue;
      const float inverse =
          (1 / full.depth_m.at<float>(4 * y + 1, 4 * x + 1) + 1 / full.depth_m.at<float>(4 * y + 2, 4 * x + 2)) / 2;
      EXPECT_NEAR(coarse.depth_m.at<float>(y, x) * inverse, 1, 1e-3);
    }
  }
}

// What depth says is the same point has the same colour from two places; what depth says is hidden has not.
TEST(RenderedWorld, ParallaxAndOcclusionFollowFromDepth) {
  const CameraModel camera;
  std::vector<double> seen;
  std::vector<double> hidden;
  for (const std::size_t i : {12U, 40U, 63U, 90U, 121U, 140U}) {
    const Pose& from = pose_at(i);
    Pose to = from;
    const double heading = from.heading_deg * 3.14159265358979 / 180;
    to.x_m += 0.12 * std::sin(heading) + 0.05 * std::cos(heading);
    to.y_m += -0.12 * std::cos(heading) + 0.05 * std::sin(heading);
    const Frame a = world().render(from, without_noise());
    const Frame b = world().render(to, without_noise());
    const double pitch = from.pitch_deg * 3.14159265358979 / 180;
    for (int y = 0; y < camera.height_px; y += 2) {
      for (int x = 0; x < camera.width_px; x += 2) {
        // In the camera: x right, y down, z forward. The second camera is 0.12 m to the right and 0.05 m ahead, on the
        // floor; the first pitches up a little.
        const double z = a.depth_m.at<float>(y, x);
        const double cx = (x - 159.5) * z / camera.focal_px - 0.12;
        const double cy = (y - 119.5) * z / camera.focal_px - 0.05 * std::sin(pitch);
        const double cz = z - 0.05 * std::cos(pitch);
        const int u = static_cast<int>(std::lround(cx / cz * camera.focal_px + 159.5));
        const int v = static_cast<int>(std::lround(cy / cz * camera.focal_px + 119.5));
        if (cz < 0.1 || u < 1 || v < 1 || u > 318 || v > 238) continue;
        const double difference = cv::norm(a.bgr.at<cv::Vec3b>(y, x), b.bgr.at<cv::Vec3b>(v, u), cv::NORM_L1) / 3;
        const double there = b.depth_m.at<float>(v, u);
        if (std::abs(there - cz) < 0.02 * cz) seen.push_back(difference);
        if (there < 0.8 * cz) hidden.push_back(difference);
      }
    }
  }
  ASSERT_GT(seen.size(), 50000U);
  ASSERT_GT(hidden.size(), 500U);
  const auto quantile = [](std::vector<double> values, double q) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  EXPECT_LT(quantile(seen, 0.5), 3);
  EXPECT_LT(quantile(seen, 0.9), 16);
  EXPECT_GT(quantile(hidden, 0.5), 20);
}

TEST(RenderedWorld, GivesSiftSomeHundredsOfFeatures) {
  std::vector<std::size_t> counts;
  for (std::size_t i = 0; i < drive().size(); i += 4)
    counts.push_back(sift(world().render(pose_at(i)).bgr).keypoints.size());
  std::sort(counts.begin(), counts.end());
  const std::size_t n = counts.size();
  EXPECT_GE(counts[n / 2], 200U);
  EXPECT_LE(counts[n / 2], 450U);
  EXPECT_GE(counts[n / 10], 80U);
  EXPECT_LE(counts[n - 1 - n / 10], 600U);
}

TEST(RenderedWorld, NoiseHasTheStrengthAskedFor) {
  CameraConditions noisy = without_noise();
  noisy.noise_sigma = 6;
  const cv::Mat clean = world().render(pose_at(50), without_noise()).bgr;
  const cv::Mat a = world().render(pose_at(50), noisy).bgr;
  noisy.noise_seed = 1;
  const cv::Mat b = world().render(pose_at(50), noisy).bgr;
  double sum = 0;
  double squares = 0;
  double product = 0;
  double count = 0;
  for (int y = 0; y < clean.rows; ++y) {
    for (int x = 0; x < clean.cols; ++x) {
      const int level = clean.at<cv::Vec3b>(y, x)[1];
      if (level < 40 || level > 215) continue;
      const double da = a.at<cv::Vec3b>(y, x)[1] - level;
      const double db = b.at<cv::Vec3b>(y, x)[1] - level;
      sum += da;
      squares += da * da;
      product += da * db;
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0, 0.2);
  EXPECT_NEAR(std::sqrt(squares / count), 6, 0.8);
  EXPECT_NEAR(product / count, 0, 1);  // another seed, other noise
}

TEST(RenderedWorld, ConditionsChangeTheLightNotTheScene) {
  CameraConditions dusk = without_noise();
  dusk.daylight = 0;
  dusk.gain = 0.7;
  const Frame day = world().render(pose_at(20), without_noise());
  const Frame evening = world().render(pose_at(20), dusk);
  EXPECT_LT(cv::mean(evening.bgr)[1], 0.85 * cv::mean(day.bgr)[1]);
  EXPECT_TRUE(same(day.depth_m, evening.depth_m));
}

TEST(RenderedWorld, LookAlikeCorridorsTemptAFalseMatch) {
  WorldOptions options{.corridors = 3, .corridor_length_m = 14, .seed = 5};
  options.look_alike_corridors = 1;
  const RenderedWorld alike(options);
  options.look_alike_corridors = 0;
  const RenderedWorld unlike(options);
  const auto compare = [](const RenderedWorld& place) {
    int sum = 0;
    for (const double x : {2.0, 5.0, 8.0, 10.0}) {
      std::vector<Pose> poses;
      for (const std::size_t corridor : {std::size_t{0}, std::size_t{2}}) {
        const Area& area = place.plan().corridors[corridor];
        poses.push_back({.x_m = x, .y_m = (area.y0 + area.y1) / 2, .heading_deg = 30});
      }
      EXPECT_EQ(shared_view(ViewRecord(place, poses[0]), ViewRecord(place, poses[1])), 0);
      sum += inliers(sift(place.render(poses[0]).bgr), sift(place.render(poses[1]).bgr));
    }
    return sum / 4;
  };
  EXPECT_GT(compare(alike), 100);
  EXPECT_LT(compare(unlike), 30);
}

TEST(RenderedWorld, LookAlikeStoreysTemptAFalseMatch) {
  WorldOptions options{.corridor_length_m = 12, .storeys = 2, .seed = 3};
  options.look_alike_storeys = 1;
  const RenderedWorld tower(options);
  const std::vector<Pose> poses = trajectory(tower, {.n_images = 60});
  for (std::size_t i = 0; i < poses.size(); i += 6) {
    Pose pose = poses[i];
    const Frame lower = tower.render(pose);
    const ViewRecord below(tower, pose);
    pose.storey = 1;
    EXPECT_EQ(shared_view(below, ViewRecord(tower, pose)), 0);
    // All but the numbers on the doors is the same.
    cv::Mat differs;
    cv::absdiff(lower.bgr, tower.render(pose).bgr, differs);
    EXPECT_LT(cv::mean(differs)[1], 2);
  }
}

TEST(RenderedWorld, APosterHangsInTwoPlacesWhenAskedTo) {
  const auto times = [](const RenderedWorld& place) {
    std::map<std::uint64_t, int> count;
    for (const Poster& poster : place.posters()) ++count[poster.design];
    return count;
  };
  WorldOptions options{.seed = 4};
  for (const auto& [design, count] : times(RenderedWorld(options))) EXPECT_EQ(count, 1) << "poster " << design;
  options.posters_in_two_places = 2;
  int twice = 0;
  for (const auto& [design, count] : times(RenderedWorld(options))) twice += count == 2;
  EXPECT_EQ(twice, 2);
}

TEST(RenderedWorld, BuildingsShareACatalogue) {
  const auto designs = [](std::uint64_t seed) {
    const RenderedWorld building(WorldOptions{.seed = seed, .catalogue_posters = 60});
    std::set<std::uint64_t> result;
    for (const Poster& poster : building.posters()) result.insert(poster.design);
    return result;
  };
  const std::set<std::uint64_t> a = designs(1);
  const std::set<std::uint64_t> b = designs(2);
  EXPECT_NE(a, b);
  EXPECT_TRUE(std::any_of(a.begin(), a.end(), [&](std::uint64_t design) { return b.contains(design); }));
}

TEST(RenderedWorld, RefusesWhatMakesNoWorld) {
  EXPECT_THROW(RenderedWorld(WorldOptions{.corridors = 0}), std::invalid_argument);
  EXPECT_THROW(RenderedWorld(WorldOptions{.corridor_length_m = 1}), std::invalid_argument);
  EXPECT_THROW(RenderedWorld(WorldOptions{.storeys = 0}), std::invalid_argument);
  EXPECT_THROW(world().render(Pose{.x_m = -50}), std::out_of_range);
  EXPECT_THROW(world().render(Pose{.x_m = 5, .y_m = 5.9, .storey = 1}), std::out_of_range);
  EXPECT_THROW(world().render_geometry(pose_at(0), 7), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld::rendered
