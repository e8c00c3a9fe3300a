#include "core/vocabulary/appearance_vector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/random.h"
#include "core/vocabulary/signature.h"

namespace mapweld {
namespace {

TEST(SnapToGrid, LiesOnTheGridAndStaysThere) {
  SplitMix64 random(5);
  const auto between = [&random](float low, float high) {
    return low + (high - low) * static_cast<float>(random.below(1 << 20)) / (1 << 20);
  };
  for (int i = 0; i < 10'000; ++i) {
    const Keypoint keypoint{between(0, 8191), between(0, 8191), between(1, 900), between(0, 360)};
    const Appearance snapped = snap_to_grid(WordId{7}, keypoint);
    EXPECT_EQ(snapped.word, WordId{7});
    EXPECT_EQ(snapped.x_px * 8, std::floor(snapped.x_px * 8));
    EXPECT_EQ(snapped.scale_px * 64, std::floor(snapped.scale_px * 64));
    EXPECT_LE(std::abs(snapped.x_px - keypoint.x_px), 1.0f / 16);
    EXPECT_LE(std::abs(snapped.y_px - keypoint.y_px), 1.0f / 16);
    EXPECT_LE(std::abs(snapped.scale_px - keypoint.scale_px), 1.0f / 128);
    const float turn = std::abs(snapped.angle_deg - keypoint.angle_deg);
    EXPECT_LE(std::min(turn, 360 - turn), 360.0f / 65536);
    EXPECT_LT(snapped.angle_deg, 360);
    const Appearance again = snap_to_grid(WordId{7}, {snapped.x_px, snapped.y_px, snapped.scale_px, snapped.angle_deg});
    EXPECT_EQ(again, snapped);
  }
}

TEST(SnapToGrid, SurvivesAWayThroughSixteenBits) {
  for (std::uint32_t steps = 0; steps < 65'536; ++steps) {
    const float angle_deg = static_cast<float>(steps) / kAnglesPerDegree;
    ASSERT_EQ(snap_to_grid(WordId{}, {0, 0, 1, angle_deg}).angle_deg, angle_deg);
    ASSERT_EQ(static_cast<std::uint32_t>(std::lround(angle_deg * kAnglesPerDegree)), steps);
  }
}

TEST(SnapToGrid, WhatLiesOutsideIsBroughtIn) {
  const Appearance low = snap_to_grid(WordId{}, {-3, -0.01f, -1, 0});
  EXPECT_EQ(low.x_px, 0);
  EXPECT_EQ(low.y_px, 0);
  EXPECT_EQ(low.scale_px, 0);
  const Appearance high = snap_to_grid(WordId{}, {1e6f, 9000, 5000, 359.9999f});
  EXPECT_EQ(high.x_px, 65'535.0f / 8);
  EXPECT_EQ(high.y_px, 65'535.0f / 8);
  EXPECT_EQ(high.scale_px, 65'535.0f / 64);
  EXPECT_EQ(high.angle_deg, 0) << "all the way around is no turn";
}

TEST(AppearanceVector, CarriesTheSignaturesOfTheDescriptors) {
  SplitMix64 random(9);
  Features features{320, 240, {}, {}};
  std::vector<WordId> words;
  for (std::uint32_t i = 0; i < 50; ++i) {
    features.keypoints.push_back({static_cast<float>(i), 7, 4, 10});
    for (int k = 0; k < kDescriptorDimension; ++k) {
      features.descriptors.push_back(static_cast<std::uint8_t>(random.below(256)));
    }
    words.push_back(WordId{i * 37 % 50});
  }
  const AppearanceVector image = make_appearance_vector(features, words);
  for (const Appearance& appearance : image.appearances) {
    const auto i = static_cast<std::size_t>(appearance.x_px);
    const std::span<const std::uint8_t> descriptors = features.descriptors;
    EXPECT_EQ(appearance.signature, signature_of(descriptors.subspan(i * kDescriptorDimension).first<128>()));
  }
  features.descriptors.clear();
  for (const Appearance& appearance : make_appearance_vector(features, words).appearances) {
    EXPECT_EQ(appearance.signature, Signature{}) << "unknown without descriptors";
  }
}

TEST(AppearanceVector, HasEveryFeatureOnceSortedByWord) {
  Features features;
  features.width_px = 320;
  features.height_px = 240;
  std::vector<WordId> words;
  for (int i = 0; i < 100; ++i) {
    features.keypoints.push_back({static_cast<float>(i), static_cast<float>(100 - i), 4, 10});
    words.push_back(WordId{static_cast<std::uint32_t>(i * 37 % 20)});
  }
  const AppearanceVector image = make_appearance_vector(features, words);
  EXPECT_EQ(image.width_px, 320);
  EXPECT_EQ(image.height_px, 240);
  ASSERT_EQ(image.appearances.size(), 100u);
  EXPECT_TRUE(std::is_sorted(image.appearances.begin(), image.appearances.end()));
  for (int i = 0; i < 100; ++i) {
    const Appearance wanted =
        snap_to_grid(words[static_cast<std::size_t>(i)], features.keypoints[static_cast<std::size_t>(i)]);
    EXPECT_EQ(std::count(image.appearances.begin(), image.appearances.end(), wanted), 1);
  }
}

TEST(AppearanceVector, NeedsAWordForEveryFeature) {
  Features features;
  features.keypoints.resize(2);
  EXPECT_THROW(make_appearance_vector(features, std::vector<WordId>(3)), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld
