// Exact: against OpenCV's brute-force matcher.
#include "tests/evaluation/nearest_descriptors.h"

#include <random>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>

namespace mapweld::evaluation {
namespace {

std::vector<std::uint8_t> random_descriptors(std::size_t n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> descriptors(n * 128);
  for (auto& component : descriptors) component = static_cast<std::uint8_t>(random() >> 24);
  return descriptors;
}

cv::Mat as_floats(std::vector<std::uint8_t>& descriptors) {
  cv::Mat floats;
  cv::Mat(static_cast<int>(descriptors.size() / 128), 128, CV_8U, descriptors.data()).convertTo(floats, CV_32F);
  return floats;
}

void expect_as_opencv(const std::vector<NearestDescriptor>& nearest, const cv::Mat& from, const cv::Mat& to) {
  std::vector<std::vector<cv::DMatch>> expected;
  cv::BFMatcher(cv::NORM_L2SQR).knnMatch(from, to, expected, 2);
  ASSERT_EQ(nearest.size(), expected.size());
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    EXPECT_EQ(nearest[i].distance2, static_cast<std::int32_t>(expected[i][0].distance)) << i;
    EXPECT_EQ(nearest[i].index, static_cast<std::uint32_t>(expected[i][0].trainIdx)) << i;
    EXPECT_EQ(nearest[i].runner_up2, expected[i].size() > 1 ? static_cast<std::int32_t>(expected[i][1].distance)
                                                            : NearestDescriptor::kNoDistance2)
        << i;
  }
}

TEST(NearestDescriptors, AreThoseOfAnExhaustiveSearch) {
  for (const auto& [na, nb] :
       {std::pair<std::size_t, std::size_t>{1, 1}, {1, 2}, {3, 16}, {5, 17}, {50, 33}, {64, 100}}) {
    auto a = random_descriptors(na, 1), b = random_descriptors(nb, 2);
    for (const bool portable : {false, true}) {
      const auto nearest = nearest_descriptors(DescriptorBlocks(a), DescriptorBlocks(b), portable);
      expect_as_opencv(nearest.of_a, as_floats(a), as_floats(b));
      expect_as_opencv(nearest.of_b, as_floats(b), as_floats(a));
    }
  }
}

TEST(NearestDescriptors, OfEquallyNearTheFirst) {
  auto a = random_descriptors(1, 1);
  std::vector<std::uint8_t> b;
  for (int i = 0; i < 20; ++i) b.insert(b.end(), a.begin(), a.end());
  const auto nearest = nearest_descriptors(DescriptorBlocks(a), DescriptorBlocks(b));
  EXPECT_EQ(nearest.of_a[0].index, 0u);
  EXPECT_EQ(nearest.of_a[0].distance2, 0);
  EXPECT_EQ(nearest.of_a[0].runner_up2, 0);
}

TEST(NearestDescriptors, OfNothingAreNone) {
  auto a = random_descriptors(3, 1);
  const auto nearest = nearest_descriptors(DescriptorBlocks(a), DescriptorBlocks({}));
  ASSERT_EQ(nearest.of_a.size(), 3u);
  EXPECT_EQ(nearest.of_a[0].distance2, NearestDescriptor::kNoDistance2);
  EXPECT_TRUE(nearest.of_b.empty());
}

}  // namespace
}  // namespace mapweld::evaluation
