#include "core/feature/mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "tests/core/feature/image_files.h"
#include "tests/core/feature/png_files.h"

namespace mapweld {
namespace {

using test::Bytes;

cv::Mat textured_grey(int width_px, int height_px, std::uint64_t seed = 1) {
  cv::Mat grey;
  cv::cvtColor(test::textured_image(width_px, height_px, seed), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

// All used but the lowest quarter and a disc.
cv::Mat some_mask(cv::Size size) {
  cv::Mat used(size, CV_8UC1, cv::Scalar(255));
  used.rowRange(size.height * 3 / 4, size.height) = cv::Scalar(0);
  cv::circle(used, {size.width / 3, size.height / 3}, size.height / 8, cv::Scalar(0), cv::FILLED);
  return used;
}

TEST(Mask, UnusedPixelsBearNoFeatures) {
  const cv::Mat grey = textured_grey(320, 240);
  const cv::Mat used = some_mask(grey.size());
  const Features features = extract_features(grey, {}, used);
  ASSERT_GT(features.keypoints.size(), 100u);
  for (const Keypoint& k : features.keypoints) {
    for (int degrees = 0; degrees < 360; degrees += 15) {
      const double angle = degrees * CV_PI / 180;
      const int x = static_cast<int>(std::lround(k.x_px + 0.9 * k.scale_px * std::cos(angle)));
      const int y = static_cast<int>(std::lround(k.y_px + 0.9 * k.scale_px * std::sin(angle)));
      if (!cv::Rect({0, 0}, grey.size()).contains({x, y})) continue;
      EXPECT_NE(used.at<std::uint8_t>(y, x), 0) << x << ' ' << y << ": within a feature";
    }
  }
}

TEST(Mask, WhatLiesUnderItHasNoInfluence) {
  const cv::Mat grey = textured_grey(320, 240);
  const cv::Mat used = some_mask(grey.size());
  const Features expected = extract_features(grey, {}, used);
  for (const double paint : {0.0, 255.0}) {
    cv::Mat painted = grey.clone();
    painted.setTo(cv::Scalar(paint), used == 0);
    EXPECT_EQ(extract_features(painted, {}, used), expected);
  }
  cv::Mat other = textured_grey(320, 240, 2);
  grey.copyTo(other, used);
  EXPECT_EQ(extract_features(other, {}, used), expected);
}

TEST(Mask, FarFromItFeaturesAreAsWithout) {
  const cv::Mat grey = textured_grey(320, 240);
  const cv::Mat used = some_mask(grey.size());
  cv::Mat distance;
  cv::distanceTransform(used, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const Features whole = extract_features(grey, {.max_features = 0});
  const Features masked = extract_features(grey, {.max_features = 0}, used);
  int far = 0;
  int again = 0;
  for (std::size_t i = 0; i < whole.keypoints.size(); ++i) {
    const Keypoint& k = whole.keypoints[i];
    if (distance.at<float>(static_cast<int>(k.y_px), static_cast<int>(k.x_px)) < 8 * k.scale_px) continue;
    ++far;
    for (std::size_t j = 0; j < masked.keypoints.size(); ++j) {
      if (std::hypot(masked.keypoints[j].x_px - k.x_px, masked.keypoints[j].y_px - k.y_px) > 0.05) continue;
      ++again;
      break;
    }
  }
  EXPECT_GT(far, 60);
  EXPECT_GE(again, far * 98 / 100);
}

// A mask over a wall without texture: its border is the only edge that there could be.
TEST(Mask, ItsBorderMakesNoFeature) {
  for (const double wall : {10.0, 128.0, 245.0}) {
    cv::Mat grey(240, 320, CV_8UC1, cv::Scalar(wall));
    for (int x = 0; x < grey.cols; ++x) grey.col(x) += cv::Scalar(x / 32.0);  // lit from one side
    const cv::Mat used = some_mask(grey.size());
    grey.setTo(cv::Scalar(0), used == 0);
    EXPECT_GT(extract_features(grey, {}).keypoints.size() + (wall < 20 ? 1 : 0), 0u)
        << "without the mask there are some";
    EXPECT_TRUE(extract_features(grey, {}, used).keypoints.empty()) << wall;
  }
}

// ... and over texture, the keypoints near it are those of the picture itself.
TEST(Mask, NearItFewFeaturesAreNew) {
  int near = 0;
  int of_the_picture = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const cv::Mat grey = textured_grey(320, 240, seed);
    const cv::Mat used = some_mask(grey.size());
    cv::Mat distance;
    cv::distanceTransform(used, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    const Features whole = extract_features(grey, {.max_features = 0});
    for (const Keypoint& k : extract_features(grey, {.max_features = 0}, used).keypoints) {
      if (distance.at<float>(static_cast<int>(k.y_px), static_cast<int>(k.x_px)) > 3 * k.scale_px) continue;
      ++near;
      for (const Keypoint& w : whole.keypoints) {
        if (std::hypot(w.x_px - k.x_px, w.y_px - k.y_px) > 0.25f * k.scale_px) continue;
        ++of_the_picture;
        break;
      }
    }
  }
  EXPECT_GT(near, 50);
  EXPECT_GE(of_the_picture, near * 9 / 10) << near;
}

TEST(Mask, TheStrongestOfThoseThatAreLeftAreChosen) {
  const cv::Mat grey = textured_grey(320, 240);
  const cv::Mat used = some_mask(grey.size());
  const Features all = extract_features(grey, {.max_features = 0}, used);
  const Features some = extract_features(grey, {.max_features = 60}, used);
  ASSERT_EQ(some.keypoints.size(), 60u);
  EXPECT_TRUE(std::equal(some.keypoints.begin(), some.keypoints.end(), all.keypoints.begin()));
}

TEST(Mask, OfALargeImageToo) {
  const cv::Mat grey = textured_grey(800, 600);
  const cv::Mat used = some_mask(grey.size());
  cv::Mat painted = grey.clone();
  painted.setTo(cv::Scalar(255), used == 0);
  const ExtractorOptions options{.max_pixels = 400 * 300};
  const Features features = extract_features(grey, options, used);
  ASSERT_GT(features.keypoints.size(), 100u);
  for (const Keypoint& k : features.keypoints) {
    EXPECT_NE(used.at<std::uint8_t>(static_cast<int>(k.y_px), static_cast<int>(k.x_px)), 0);
  }
  EXPECT_TRUE(extract_features(grey, options, cv::Mat(grey.size(), CV_8UC1, cv::Scalar(0))).keypoints.empty());
}

TEST(Mask, OfAnotherSizeIsRefused) {
  EXPECT_THROW(extract_features(cv::Mat(10, 10, CV_8UC1), {}, cv::Mat(10, 9, CV_8UC1)), std::invalid_argument);
}

TEST(Mask, FillingIsSmooth) {
  cv::Mat grey(60, 90, CV_8UC1);
  for (int x = 0; x < grey.cols; ++x) grey.col(x) = cv::Scalar(2 * x);
  cv::Mat used(grey.size(), CV_8UC1, cv::Scalar(255));
  used({30, 20, 25, 20}) = cv::Scalar(0);
  cv::Mat holed = grey.clone();
  holed.setTo(cv::Scalar(255), used == 0);
  const cv::Mat filled = fill_unused(holed, used);
  EXPECT_EQ(cv::norm(filled, grey, cv::NORM_INF, used), 0) << "used pixels stay";
  EXPECT_LE(cv::norm(filled, grey, cv::NORM_INF), 30);
  cv::Mat one(7, 5, CV_8UC1, cv::Scalar(0));
  one.at<std::uint8_t>(3, 3) = 99;
  cv::Mat only(one.size(), CV_8UC1, cv::Scalar(0));
  only.at<std::uint8_t>(3, 3) = 255;
  EXPECT_EQ(cv::norm(fill_unused(one, only), cv::Mat(one.size(), CV_8UC1, cv::Scalar(99)), cv::NORM_INF), 0);
}

TEST(Mask, IsScaledByTheNearestPixel) {
  cv::Mat mask(2, 2, CV_8UC1, cv::Scalar(255));
  mask.at<std::uint8_t>(0, 1) = 0;
  const cv::Mat scaled = combined_masks({}, mask, {8, 6});
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) EXPECT_EQ(scaled.at<std::uint8_t>(y, x), x >= 4 && y < 3 ? 0 : 255);
  }
  EXPECT_TRUE(combined_masks({}, {}, {8, 6}).empty());
  EXPECT_TRUE(combined_masks({}, cv::Mat(3, 3, CV_8UC1, cv::Scalar(255)), {8, 6}).empty()) << "white all over";
  cv::Mat used(6, 8, CV_8UC1, cv::Scalar(255));
  used.at<std::uint8_t>(5, 0) = 0;
  EXPECT_EQ(cv::countNonZero(combined_masks(used, mask, {8, 6})), 8 * 6 - 12 - 1);
}

cv::Mat mask_in(const Bytes& png) { return mask_of(decode_image(png, {.stretch = false})); }

std::string code_of(const Bytes& bytes) {
  try {
    mask_in(bytes);
  } catch (const ImageError& error) {
    return error.code();
  }
  return "decoded";
}

TEST(Mask, FromAFile) {
  const cv::Mat used = some_mask({64, 48});
  EXPECT_EQ(cv::norm(mask_in(test::encode(".png", used)), used, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(mask_in(test::encode(".png", used / 255)), used, cv::NORM_INF), 0) << "0 and 1";
  cv::Mat colour;
  cv::cvtColor(used, colour, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(cv::norm(mask_in(test::encode(".png", colour)), used, cv::NORM_INF), 0);
  cv::Mat wide;
  used.convertTo(wide, CV_16U, 257);
  EXPECT_EQ(cv::norm(mask_in(test::encode(".png", wide)), used, cv::NORM_INF), 0);
  // White, and transparent where it is not used.
  const test::PngLayout layout{.width_px = 64, .height_px = 48, .colour = test::PngColour::kGreyAlpha};
  const Bytes alpha = test::encode_png(layout, [&](int x, int y) {
    return std::array<std::uint16_t, 4>{255, used.at<std::uint8_t>(y, x)};
  });
  EXPECT_EQ(cv::norm(mask_in(alpha), used, cv::NORM_INF), 0);
  EXPECT_EQ(code_of(test::encode(".jpg", used)), "unsupported_image");
  EXPECT_EQ(code_of(test::encode(".png", cv::Mat(9, 9, CV_8UC1, cv::Scalar(0)))), "empty_mask");
  EXPECT_EQ(code_of({}), "empty_body");
}

}  // namespace
}  // namespace mapweld
