#include "core/feature/extractor.h"

#include <cmath>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/core/feature/image_files.h"

namespace mapweld {
namespace {

cv::Mat textured_grey(int width_px, int height_px, std::uint64_t seed = 1) {
  cv::Mat grey;
  cv::cvtColor(test::textured_image(width_px, height_px, seed), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

// A round bright spot on grey with its centre anywhere between pixels.
cv::Mat spot(int width_px, int height_px, float x_px, float y_px, float sigma_px) {
  cv::Mat image(height_px, width_px, CV_8UC1);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const float square = std::pow(static_cast<float>(x) - x_px, 2.0f) + std::pow(static_cast<float>(y) - y_px, 2.0f);
      image.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>(std::lround(60 + 180 * std::exp(-square / (2 * sigma_px * sigma_px))));
    }
  }
  return image;
}

TEST(Extractor, FindsWhatOpenCvFinds) {
  const cv::Mat grey = textured_grey(320, 240);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::SIFT::create()->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  const Features features = extract_features(grey, {.max_features = 0});
  ASSERT_EQ(features.keypoints.size(), keypoints.size());
  ASSERT_GT(features.keypoints.size(), 100u);

  std::multiset<std::vector<float>> expected;
  for (int i = 0; i < descriptors.rows; ++i) {
    expected.insert(std::vector<float>(descriptors.ptr<float>(i), descriptors.ptr<float>(i) + kDescriptorDimension));
  }
  std::multiset<std::vector<float>> found;
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    const auto first = features.descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorDimension);
    found.insert(std::vector<float>(first, first + kDescriptorDimension));
  }
  EXPECT_EQ(found, expected);
}

TEST(Extractor, ASpotIsFoundWhereItIs) {
  const cv::Point2f centre(101.3f, 70.6f);
  const Features features = extract_features(spot(200, 150, centre.x, centre.y, 4), {});
  ASSERT_FALSE(features.keypoints.empty());
  EXPECT_NEAR(features.keypoints[0].x_px, centre.x, 0.06);
  EXPECT_NEAR(features.keypoints[0].y_px, centre.y, 0.06);
  EXPECT_EQ(features.width_px, 200);
  EXPECT_EQ(features.height_px, 150);
}

TEST(Extractor, InALargeImageToo) {
  const cv::Point2f centre(1203.0f, 402.0f);
  ExtractorOptions options;
  options.max_pixels = 400 * 300;
  const Features features = extract_features(spot(1600, 1200, centre.x, centre.y, 24), options);
  const Features reference = extract_features(spot(400, 300, centre.x / 4, centre.y / 4, 6), {});
  ASSERT_FALSE(features.keypoints.empty());
  EXPECT_NEAR(features.keypoints[0].x_px, centre.x, 0.5);
  EXPECT_NEAR(features.keypoints[0].y_px, centre.y, 0.5);
  EXPECT_NEAR(features.keypoints[0].scale_px, 4 * reference.keypoints[0].scale_px, 1);
  EXPECT_EQ(features.width_px, 1600);
}

TEST(Extractor, FewerFeaturesAreTheFirstOfMore) {
  const cv::Mat grey = textured_grey(320, 240);
  const Features all = extract_features(grey, {.max_features = 0});
  for (const int count : {1, 2, 50, 200}) {
    const Features some = extract_features(grey, {.max_features = count});
    ASSERT_EQ(some.keypoints.size(), static_cast<std::size_t>(count));
    EXPECT_TRUE(std::equal(some.keypoints.begin(), some.keypoints.end(), all.keypoints.begin()));
    EXPECT_TRUE(std::equal(some.descriptors.begin(), some.descriptors.end(), all.descriptors.begin()));
  }
}

// Four copies of one patch give features of equal strength: the cut must fall by position.
TEST(Extractor, TiesFallByPosition) {
  const cv::Mat patch = textured_grey(64, 64);
  cv::Mat row;
  cv::hconcat(std::vector<cv::Mat>{patch, patch}, row);
  cv::Mat tiled;
  cv::vconcat(std::vector<cv::Mat>{row, row}, tiled);
  const Features all = extract_features(tiled, {.max_features = 0});
  const Features some = extract_features(tiled, {.max_features = 17});
  ASSERT_EQ(some.keypoints.size(), 17u);
  EXPECT_TRUE(std::equal(some.keypoints.begin(), some.keypoints.end(), all.keypoints.begin()));
}

TEST(Extractor, SameFeaturesWhateverRunsBeside) {
  const cv::Mat grey = textured_grey(320, 240);
  const Features expected = extract_features(grey, {});
  std::vector<Features> found(4);
  {
    std::vector<std::jthread> threads;
    for (Features& features : found) threads.emplace_back([&] { features = extract_features(grey, {}); });
  }
  for (const Features& features : found) EXPECT_EQ(features, expected);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  EXPECT_EQ(extract_features(grey, {}), expected);
  cv::setNumThreads(threads);
}

TEST(Extractor, SmallAndBlankImagesGiveNone) {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(1, 300), cv::Size(300, 1), cv::Size(2, 2), cv::Size(5, 3), cv::Size(8, 8)}) {
    const Features features = extract_features(cv::Mat(size, CV_8UC1, cv::Scalar(128)), {});
    EXPECT_TRUE(features.keypoints.empty());
    EXPECT_EQ(features.width_px, size.width);
    EXPECT_EQ(features.height_px, size.height);
  }
  EXPECT_TRUE(extract_features(cv::Mat(240, 320, CV_8UC1, cv::Scalar(200)), {}).keypoints.empty());
  EXPECT_TRUE(extract_features(cv::Mat(0, 0, CV_8UC1), {}).keypoints.empty());
}

TEST(Extractor, ThinImagesOfNoiseDoNotThrow) {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(8192, 1), cv::Size(1, 8192), cv::Size(3, 2000), cv::Size(7, 7), cv::Size(12, 12)}) {
    cv::Mat noise(size, CV_8UC1);
    cv::RNG generator(1);
    generator.fill(noise, cv::RNG::UNIFORM, 0, 256);
    EXPECT_NO_THROW(extract_features(noise, {})) << size;
  }
}

TEST(Extractor, OtherPixelsAreRefused) {
  EXPECT_THROW(extract_features(cv::Mat(10, 10, CV_8UC3), {}), std::invalid_argument);
  EXPECT_THROW(extract_features(cv::Mat(10, 10, CV_8UC1), {.max_features = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld
