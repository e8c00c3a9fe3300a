// Pictures that use little of their range, and those that must not be touched.
#include "core/feature/contrast.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "tests/core/feature/image_files.h"

namespace mapweld {
namespace {

using test::Bytes;

cv::Mat plain_picture(std::uint64_t seed = 1) {
  cv::Mat grey;
  cv::cvtColor(test::textured_image(320, 240, seed), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

// A picture whose levels 0..255 stand at first .. first + span.
cv::Mat squeezed(const cv::Mat& grey, int type, double first, double span) {
  cv::Mat out;
  grey.convertTo(out, type, span / 255, first);
  return out;
}

// How many keypoints of `a` have one of `b` within half a pixel.
std::size_t found_again(const Features& a, const Features& b) {
  std::size_t count = 0;
  for (const Keypoint& p : a.keypoints) {
    for (const Keypoint& q : b.keypoints) {
      if (std::hypot(p.x_px - q.x_px, p.y_px - q.y_px) > 0.5f) continue;
      ++count;
      break;
    }
  }
  return count;
}

void expect_about_as_plain(const cv::Mat& squeezed, const cv::Mat& plain, double share) {
  const Features expected = extract_features(plain, {});
  const Features found = extract_features(stretched_to_8_bits(squeezed), {});
  ASSERT_GT(expected.keypoints.size(), 200u);
  EXPECT_GE(static_cast<double>(found.keypoints.size()), 0.8 * static_cast<double>(expected.keypoints.size()));
  EXPECT_GE(static_cast<double>(found_again(expected, found)), share * static_cast<double>(expected.keypoints.size()));
}

TEST(Contrast, NarrowPicturesGiveFeaturesAboutAsPlainly) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const cv::Mat plain = plain_picture(seed);
    expect_about_as_plain(squeezed(plain, CV_16U, 7600, 500), plain, 0.8);      // thermal
    expect_about_as_plain(squeezed(plain, CV_16U, 51241, 940), plain, 0.8);     // ... in hot weather
    expect_about_as_plain(squeezed(plain, CV_16U, 0, 4095), plain, 0.8);        // 12 bits
    expect_about_as_plain(squeezed(plain, CV_16U, 0, 1023), plain, 0.8);        // 10 bits
    expect_about_as_plain(squeezed(plain, CV_16U, 0, 16383), plain, 0.8);       // 14 bits
    expect_about_as_plain(squeezed(plain, CV_8U, 112, 255.0 / 8), plain, 0.6);  // an eighth of its contrast
    expect_about_as_plain(squeezed(plain, CV_8U, 0, 255.0 / 8), plain, 0.6);    // ... and dark
  }
}

TEST(Contrast, OrdinaryPicturesAreLeftBitForBit) {
  const cv::Mat plain = plain_picture();
  for (const double span : {255.0, 200.0, 150.0, 110.0}) {
    const cv::Mat picture = squeezed(plain, CV_8U, 20, span);
    EXPECT_EQ(cv::norm(stretched_to_8_bits(picture), picture, cv::NORM_INF), 0) << span;
    cv::Mat wide;
    picture.convertTo(wide, CV_16U, 257);
    EXPECT_EQ(cv::norm(stretched_to_8_bits(wide), picture, cv::NORM_INF), 0) << "the same picture in 16 bits";
  }
}

// A picture that grows fainter loses features little by little, with no jump where stretching begins.
TEST(Contrast, StretchingBeginsWithoutAStep) {
  const cv::Mat plain = plain_picture();
  double before = 0;
  for (double span = 120; span > 30; span *= 0.98) {
    const double now = static_cast<double>(
        extract_features(stretched_to_8_bits(squeezed(plain, CV_8U, 60, span)), {.max_features = 0}).keypoints.size());
    if (before > 0) {
      EXPECT_NEAR(now, before, 0.2 * before) << span;
    }
    before = now;
  }
}

TEST(Contrast, HotAndDeadPixelsDoNotCount) {
  const cv::Mat plain = plain_picture();
  for (const int type : {CV_16U, CV_8U}) {
    cv::Mat picture = type == CV_16U ? squeezed(plain, CV_16U, 7600, 500) : squeezed(plain, CV_8U, 112, 255.0 / 8);
    const double white = type == CV_16U ? 65535 : 255;
    for (int i = 0; i < 60; ++i) {
      picture({(i * 131) % 320, (i * 71) % 240, 1, 1}) = cv::Scalar(i % 2 == 0 ? white : 0);
    }
    expect_about_as_plain(picture, plain, type == CV_16U ? 0.7 : 0.5);
  }
}

TEST(Contrast, NorDoBlackAndWhiteBorders) {
  const cv::Mat plain = plain_picture();
  for (const double border : {0.0, 65535.0}) {
    // A letterbox, and the corners that a lens leaves.
    cv::Mat boxed = squeezed(plain, CV_16U, 7600, 500);
    boxed.rowRange(0, 20) = cv::Scalar(border);
    boxed.rowRange(220, 240) = cv::Scalar(border);
    EXPECT_GT(found_again(extract_features(plain, {}), extract_features(stretched_to_8_bits(boxed), {})), 200u);
    cv::Mat circle(240, 320, CV_8UC1, cv::Scalar(0));
    cv::circle(circle, {160, 120}, 150, cv::Scalar(255), cv::FILLED);
    cv::Mat round = squeezed(plain, CV_16U, 7600, 500);
    round.setTo(cv::Scalar(border), circle == 0);
    EXPECT_GT(found_again(extract_features(plain, {}), extract_features(stretched_to_8_bits(round), {})), 200u);
  }
}

TEST(Contrast, WhatIsNotUsedDoesNotCount) {
  const cv::Mat plain = plain_picture();
  cv::Mat picture = squeezed(plain, CV_16U, 7600, 500);
  cv::Mat used(picture.size(), CV_8UC1, cv::Scalar(255));
  const cv::Rect logo(100, 80, 120, 60);
  picture(logo) = cv::Scalar(40000);
  used(logo) = cv::Scalar(0);
  const cv::Mat stretched = stretched_to_8_bits(picture, used);
  double low = 0;
  double high = 0;
  cv::minMaxLoc(stretched, &low, &high, nullptr, nullptr, used);
  EXPECT_GT(high - low, 200);
}

TEST(Contrast, APictureOfOneValueStaysOne) {
  for (const int type : {CV_8UC1, CV_16UC1}) {
    const cv::Mat flat(30, 40, type, cv::Scalar(type == CV_8UC1 ? 77 : 77 * 257));
    const cv::Mat out = stretched_to_8_bits(flat);
    EXPECT_EQ(cv::norm(out, cv::Mat(30, 40, CV_8UC1, cv::Scalar(77)), cv::NORM_INF), 0);
  }
  EXPECT_NO_THROW(stretched_to_8_bits(cv::Mat(1, 1, CV_16UC1, cv::Scalar(9))));
  EXPECT_NO_THROW(stretched_to_8_bits(cv::Mat(2, 1, CV_8UC1, cv::Scalar(0))));
}

// A covered lens: nothing but the noise of the sensor, which must not become features.
TEST(Contrast, NoiseAloneStaysNoise) {
  cv::RNG random(7);
  for (const double deviation : {0.4, 1.0, 2.0, 4.0}) {
    cv::Mat noise(240, 320, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 12, deviation);
    cv::Mat dark;
    noise.convertTo(dark, CV_8U);
    EXPECT_LE(extract_features(stretched_to_8_bits(dark), {}).keypoints.size(), 5u) << deviation;
    cv::Mat thermal;
    noise.convertTo(thermal, CV_16U, 10, 8000);
    EXPECT_LE(extract_features(stretched_to_8_bits(thermal), {}).keypoints.size(), 5u) << deviation;
  }
}

TEST(Contrast, DecodingStretchesBeforeDepthIsLost) {
  const cv::Mat plain = plain_picture();
  const Bytes png = test::encode(".png", squeezed(plain, CV_16U, 7600, 500));
  const cv::Mat grey = decode_grey(png);
  EXPECT_EQ(cv::norm(grey, stretched_to_8_bits(squeezed(plain, CV_16U, 7600, 500)), cv::NORM_INF), 0);
  EXPECT_LE(cv::norm(decode_grey(png, {.stretch = false}), cv::Mat(grey.size(), CV_8UC1, cv::Scalar(30)), cv::NORM_INF),
            2);
}

TEST(Contrast, TheCasesThatUsersSent) {
  namespace fs = std::filesystem;
  const char* photographs = std::getenv("MAPWELD_PHOTOS");
  const fs::path folder =
      (photographs != nullptr && *photographs != '\0' ? fs::path(photographs)
                                                      : fs::path(MAPWELD_SOURCE_DIR) / ".." / "shared" / "data") /
      ".." / "cases" / "narrow-range";
  if (!fs::is_directory(folder)) GTEST_SKIP() << folder << " is not here (beside MAPWELD_PHOTOS)";
  const auto features_of = [&](const char* name) {
    std::ifstream file(folder / name, std::ios::binary);
    return extract_features(decode_grey(Bytes{std::istreambuf_iterator<char>(file), {}}));
  };
  const Features plain = features_of("plain-8-bit.png");
  ASSERT_GT(plain.keypoints.size(), 100u);
  for (const char* name : {"12-bit-in-16.png", "7600-to-8100-of-16-bit.png", "contrast-an-eighth.png"}) {
    const Features found = features_of(name);
    EXPECT_GE(found.keypoints.size(), plain.keypoints.size() * 9 / 10) << name;
    EXPECT_GE(found_again(plain, found), plain.keypoints.size() * 6 / 10) << name;
  }
}

}  // namespace
}  // namespace mapweld
