// Relative poses of pairs that the verifier accepts, against what the rendered world knows.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/pose/relative_pose.h"
#include "tests/support/posed_pairs.h"

namespace mapweld::rendered {
namespace {

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values.at(static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

TEST(RenderedPose, IsNearTheTruthAndATurnHasNoDirection) {
  const PosedPairsOptions options{.n_images_a = 30, .n_images_b = 20, .seed = 402, .threads = 2};
  const Camera camera = camera_of(options.camera);
  std::vector<double> rotation_deg, direction_deg;
  int moved = 0, turned = 0, turned_told = 0, far_off = 0;
  for (const PosedPair& pair : posed_pairs(options)) {
    if (pair.shared < 0.02) continue;  // the verifier was taken in
    const auto pose = relative_pose(*pair.a, camera, *pair.b, camera, pair.verification.inlier_matches);
    const bool on_one_spot = pair.truth.distance_m < 0.02;
    ++(on_one_spot ? turned : moved);
    if (!pose) continue;
    rotation_deg.push_back(angle_deg(pose->rotation, pair.truth.rotation));
    if (!pose->direction) continue;
    if (on_one_spot) {
      ++turned_told;
    } else {
      direction_deg.push_back(angle_deg(*pose->direction, *pair.truth.direction));
      far_off += direction_deg.back() > 20 ? 1 : 0;
    }
  }
  ASSERT_GT(moved, 100);
  ASSERT_GT(turned, 10);
  const auto told = static_cast<int>(direction_deg.size());
  RecordProperty("moved", moved);
  RecordProperty("told", told);
  RecordProperty("turned", turned);
  EXPECT_LT(quantile(rotation_deg, 0.5), 0.6);
  EXPECT_LT(quantile(rotation_deg, 0.9), 3);
  EXPECT_LT(quantile(direction_deg, 0.5), 1.5);
  EXPECT_LT(quantile(direction_deg, 0.9), 6);
  EXPECT_GT(told, moved / 2);
  EXPECT_LE(far_off, told / 50);
  EXPECT_LE(turned_told, turned / 10);
}

}  // namespace
}  // namespace mapweld::rendered
