#include "core/mapping/unmoved_view.h"

#include <cstdint>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "core/vocabulary/appearance_vector.h"

namespace mapweld {
namespace {

// How the second image of a pair came about: where the feature at (x, y) of the first has gone.
using Motion = std::pair<float, float> (*)(float x_px, float y_px);

struct Pair {
  AppearanceVector a;
  AppearanceVector b;
  Verification verification;
};

// `features` in each image, of which `matched` are inliers: those of the first with those of the second.
Pair pair_of(int features, int matched, Motion motion, double noise_px = 0, int width_px = 640, int height_px = 480) {
  Pair pair;
  std::mt19937_64 random(42);
  std::uniform_real_distribution<float> unit(0, 1);
  std::normal_distribution<float> noise(0, static_cast<float>(noise_px));
  for (AppearanceVector* image : {&pair.a, &pair.b}) {
    image->width_px = width_px;
    image->height_px = height_px;
  }
  for (int i = 0; i < features; ++i) {
    const float x = unit(random) * static_cast<float>(width_px);
    const float y = unit(random) * static_cast<float>(height_px);
    const auto [u, v] = motion(x, y);
    pair.a.appearances.push_back({WordId{static_cast<std::uint32_t>(i)}, x, y, 4, 0});
    pair.b.appearances.push_back({WordId{static_cast<std::uint32_t>(i)}, u + noise(random), v + noise(random), 4, 0});
    if (i < matched) {
      pair.verification.inlier_matches.emplace_back(static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(i));
    }
  }
  pair.verification.accepted = true;
  pair.verification.inliers = matched;
  return pair;
}

bool is_unmoved(const Pair& pair) { return is_unmoved_view(pair.a, pair.b, pair.verification); }

std::pair<float, float> still(float x, float y) { return {x, y}; }
std::pair<float, float> a_pixel_aside(float x, float y) { return {x + 1, y}; }
// Down a corridor: what is far, in the middle, hardly moves.
std::pair<float, float> forward(float x, float y) { return {320 + (x - 320) * 1.01f, 240 + (y - 240) * 1.01f}; }

TEST(UnmovedView, ACameraAtRest) {
  EXPECT_TRUE(is_unmoved(pair_of(133, 120, still)));
  EXPECT_TRUE(is_unmoved(pair_of(133, 75, still, 0.3))) << "with the noise of a dim picture";
  EXPECT_TRUE(is_unmoved(pair_of(12, 10, still)));
}

TEST(UnmovedView, ASlowCameraOnASparsePlaceMoves) {
  EXPECT_FALSE(is_unmoved(pair_of(133, 133, a_pixel_aside)));
  EXPECT_FALSE(is_unmoved(pair_of(133, 133, forward)));
  EXPECT_FALSE(is_unmoved(pair_of(12, 12, a_pixel_aside)));
}

// A camera's own text stays where it is before any wall.
TEST(UnmovedView, AFewThatStayAreNoView) {
  EXPECT_FALSE(is_unmoved(pair_of(133, 60, still)));
  EXPECT_FALSE(is_unmoved(pair_of(500, 190, still)));
  Verification none;
  EXPECT_FALSE(is_unmoved_view({}, {}, none));
}

// The image with fewer features counts: what the other has beside, it cannot match.
TEST(UnmovedView, OfTheImageWithFewerFeatures) {
  Pair pair = pair_of(200, 100, still);
  pair.a.appearances.resize(120);
  EXPECT_TRUE(is_unmoved(pair));
}

TEST(UnmovedView, LengthsGrowWithImagesThatAreShrunk) {
  const auto two_pixels = [](float x, float y) { return std::pair(x + 2, y); };
  EXPECT_FALSE(is_unmoved(pair_of(100, 100, two_pixels)));
  EXPECT_TRUE(is_unmoved(pair_of(100, 100, two_pixels, 0, 4000, 3000))) << "0.6 pixels of a megapixel";
  Pair other_size = pair_of(100, 100, still);
  other_size.b.width_px = 320;
  EXPECT_FALSE(is_unmoved(other_size));
}

}  // namespace
}  // namespace mapweld
