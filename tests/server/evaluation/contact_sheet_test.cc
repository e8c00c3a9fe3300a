#include "server/evaluation/contact_sheet.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace mapweld::server::evaluation {
namespace {

std::vector<std::uint8_t> plain_image(int width, int height, const cv::Scalar& bgr) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", cv::Mat(height, width, CV_8UC3, bgr), bytes);
  return bytes;
}

TEST(ContactSheet, SetsTheImagesOfAPairSideBySide) {
  const auto red = plain_image(640, 480, {0, 0, 255}), green = plain_image(100, 200, {0, 255, 0});
  const std::vector<SheetPair> pairs{{red, green, "one"}, {green, {}, "two"}, {red, red, "three"}};
  const cv::Mat sheet = cv::imdecode(contact_sheet(pairs), cv::IMREAD_COLOR);
  ASSERT_FALSE(sheet.empty());
  const auto at = [&](int x, int y) { return sheet.at<cv::Vec3b>(y, x); };
  EXPECT_EQ(at(10 + 160, 10 + 120), cv::Vec3b(0, 0, 255)) << "left image of the first pair";
  EXPECT_EQ(at(10 + 324 + 160, 10 + 120), cv::Vec3b(0, 255, 0)) << "right image of the first pair";
  EXPECT_EQ(at(10 + 324 + 10, 10 + 120), cv::Vec3b(225, 225, 225)) << "a tall image is not stretched";
  EXPECT_EQ(at(10 + 654 + 324 + 160, 10 + 120), cv::Vec3b(225, 225, 225)) << "bytes that were not kept";
  EXPECT_EQ(at(10 + 160, 10 + 272 + 120), cv::Vec3b(0, 0, 255)) << "the third pair begins a row";
}

TEST(ContactSheet, RefusesWhatIsNoImage) {
  const std::vector<SheetPair> pairs{{{1, 2, 3}, {}, "broken"}};
  EXPECT_THROW(contact_sheet(pairs), std::runtime_error);
}

}  // namespace
}  // namespace mapweld::server::evaluation
