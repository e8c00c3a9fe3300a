// Storeys that were built alike and have aged each on its own (WorldOptions::worn_copies).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/support/image_checksum.h"
#include "tests/support/rendered_world.h"
#include "tests/support/rendering/floor_plan.h"
#include "tests/support/shared_view.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

WorldOptions twins(double worn_copies, double look_alike = 1) {
  WorldOptions options{.corridor_length_m = 12, .storeys = 2, .seed = 3};
  options.look_alike_storeys = look_alike;
  options.worn_copies = worn_copies;
  return options;
}
const RenderedWorld& as_new() {
  static const RenderedWorld instance(twins(0));
  return instance;
}
const RenderedWorld& worn() {
  static const RenderedWorld instance(twins(1));
  return instance;
}

std::vector<Pose> some_poses(int storey) {
  std::vector<Pose> poses;
  const auto drive = trajectory(as_new(), {.n_images = 200, .seed = 3});
  for (std::size_t i = 0; i < drive.size(); i += 16) {
    poses.push_back(drive[i]);
    poses.back().storey = storey;
  }
  return poses;
}

double difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat differs;
  cv::absdiff(a, b, differs);
  const cv::Scalar mean = cv::mean(differs);
  return (mean[0] + mean[1] + mean[2]) / 3;
}

// Over some poses, how much the storeys differ at the same pose.
double difference_of_storeys(const RenderedWorld& world) {
  double sum = 0;
  const auto lower = some_poses(0), upper = some_poses(1);
  for (std::size_t i = 0; i < lower.size(); ++i) {
    sum += difference(world.render(lower[i]).bgr, world.render(upper[i]).bgr);
  }
  return sum / static_cast<double>(lower.size());
}

struct Known {
  std::size_t image;
  int storey;
  std::uint64_t checksum;
};
void expect_frames(const RenderedWorld& world, const std::vector<Known>& frames) {
  const auto drive = trajectory(world, {.n_images = 200, .seed = 3});
  for (const Known& known : frames) {
    Pose pose = drive[known.image];
    pose.storey = known.storey;
    EXPECT_EQ(checksum(world.render(pose).bgr), known.checksum) << known.image << ", storey " << known.storey;
  }
}

// Checksums of frames rendered before there was any wear.
TEST(WornWorld, WithoutWearNoPixelHasChanged) {
  expect_frames(RenderedWorld(twins(0, 0.9)), {{3, 0, 1433384554487014187ULL},
                                               {3, 1, 13060684209689815833ULL},
                                               {60, 0, 10263178577769192717ULL},
                                               {60, 1, 10263178577769192717ULL},
                                               {110, 0, 15598287648184983110ULL},
                                               {110, 1, 15598287648184983110ULL},
                                               {170, 0, 16033032088813087550ULL},
                                               {170, 1, 13469355593970480629ULL}});
}

// As RenderedWorld.IsFrozen: figures in docs/ are measured on it.
TEST(WornWorld, IsFrozen) {
  expect_frames(worn(), {{3, 0, 1020763783821831447ULL},
                         {3, 1, 11230886711099377419ULL},
                         {110, 0, 14887651483351080052ULL},
                         {110, 1, 4200570869343121156ULL}});
}

TEST(WornWorld, IsTheSameFromTheSameOptions) {
  const RenderedWorld again(twins(1));
  for (const int storey : {0, 1}) {
    for (const Pose& pose : some_poses(storey)) {
      const Frame a = worn().render(pose);
      const Frame b = again.render(pose);
      EXPECT_EQ(checksum(a.bgr), checksum(b.bgr));
      EXPECT_EQ(checksum(a.depth_m), checksum(b.depth_m));
    }
  }
}

TEST(WornWorld, StoreysDifferTheMoreTheyAreWorn) {
  const double little = difference_of_storeys(RenderedWorld(twins(0.3)));
  const double much = difference_of_storeys(worn());
  EXPECT_GT(little, difference_of_storeys(as_new()) + 2);
  EXPECT_GT(much, little + 2);
}

TEST(WornWorld, EveryStoreyHasWearOfItsOwn) {
  for (const int storey : {0, 1}) {
    double sum = 0;
    for (const Pose& pose : some_poses(storey)) sum += difference(worn().render(pose).bgr, as_new().render(pose).bgr);
    EXPECT_GT(sum / static_cast<double>(some_poses(storey).size()), 5) << "storey " << storey;
  }
}

// Walls, doors and furniture stand where they stood; a chair or a plant may not.
TEST(WornWorld, KeepsPlanAndGeometry) {
  EXPECT_EQ(worn().plan().rooms.size(), as_new().plan().rooms.size());
  int same = 0, all = 0;
  for (const int storey : {0, 1}) {
    for (const Pose& pose : some_poses(storey)) {
      EXPECT_EQ(worn().is_free(pose, 0.1), as_new().is_free(pose, 0.1));
      const cv::Mat a = as_new().render_geometry(pose, 4).depth_m;
      const cv::Mat b = worn().render_geometry(pose, 4).depth_m;
      for (int y = 0; y < a.rows; ++y) {
        for (int x = 0; x < a.cols; ++x) {
          // The frame of a picture is some centimetres thick.
          same += std::abs(a.at<float>(y, x) - b.at<float>(y, x)) < 0.05F + 0.02F * a.at<float>(y, x) ? 1 : 0;
          ++all;
        }
      }
    }
  }
  EXPECT_GT(same, 0.9 * all);
}

TEST(WornWorld, StoreysShareNothing) {
  const auto lower = some_poses(0), upper = some_poses(1);
  for (std::size_t i = 0; i < lower.size(); i += 5) {
    EXPECT_EQ(shared_view(ViewRecord(worn(), lower[i]), ViewRecord(worn(), upper[i])), 0);
    EXPECT_GT(shared_view(ViewRecord(worn(), lower[i]), ViewRecord(worn(), lower[i])), 0.95);
  }
}

TEST(WornWorld, LeavesNoPixelUnpainted) {
  for (const Pose& pose : some_poses(1)) {
    double least = 0;
    cv::minMaxLoc(worn().render_geometry(pose, 2).surface, &least);
    EXPECT_GE(least, 0);
  }
}

TEST(WornWorld, RefusesWhatIsNoWear) {
  EXPECT_THROW(RenderedWorld{twins(-0.1)}, std::invalid_argument);
  EXPECT_THROW(RenderedWorld{twins(1.1)}, std::invalid_argument);
}

}  // namespace
}  // namespace mapweld::rendered
