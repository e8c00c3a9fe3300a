#include "core/feature/shrink.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "tests/core/feature/image_files.h"

namespace mapweld {
namespace {

using test::Bytes;

// Red on the left, blue on the right, a bright stripe along the top.
cv::Mat flag(int width_px, int height_px) {
  cv::Mat image(height_px, width_px, CV_8UC3, cv::Scalar(0, 0, 200));
  image.colRange(width_px / 2, width_px) = cv::Scalar(200, 0, 0);
  image.rowRange(0, height_px / 8) = cv::Scalar(255, 255, 255);
  return image;
}

cv::Mat shrunk(const Bytes& file, int width_px) {
  const Bytes smaller = shrink_image(file, width_px);
  return smaller.empty() ? cv::Mat() : cv::imdecode(smaller, cv::IMREAD_UNCHANGED);
}

double mean_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total() * a.channels());
}

TEST(Shrink, KeepsFormatAspectAndColour) {
  for (const char* ending : {".jpg", ".png"}) {
    const Bytes file = test::encode(ending, flag(640, 480));
    const Bytes smaller = shrink_image(file, 100);
    EXPECT_EQ(read_image_header(smaller).format, read_image_header(file).format);
    const cv::Mat picture = cv::imdecode(smaller, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(picture.size(), cv::Size(100, 75));
    EXPECT_LT(mean_difference(picture, flag(100, 75)), 8) << ending;
  }
}

TEST(Shrink, NeverMakesAnImageLarger) {
  const Bytes file = test::encode(".png", flag(64, 48));
  EXPECT_TRUE(shrink_image(file, 64).empty());
  EXPECT_TRUE(shrink_image(file, 4096).empty());
  EXPECT_EQ(shrunk(file, 63).size(), cv::Size(63, 47));
  EXPECT_EQ(shrunk(test::encode(".png", cv::Mat(1, 1000, CV_8UC1, cv::Scalar(9))), 16).size(), cv::Size(16, 1));
}

// OpenCV's own reading of EXIF in a JPEG is the oracle; of all orientations.
TEST(Shrink, GivesAnUprightPicture) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const Bytes jpeg = test::with_jpeg_exif(test::encode(".jpg", flag(320, 240)), test::exif_block(orientation, true));
    const cv::Mat seen = cv::imdecode(jpeg, cv::IMREAD_COLOR);
    const cv::Mat small = shrunk(jpeg, 120);
    ASSERT_EQ(small.size(), cv::Size(120, orientation < 5 ? 90 : 160)) << orientation;
    cv::Mat expected;
    cv::resize(seen, expected, small.size(), 0, 0, cv::INTER_AREA);
    EXPECT_LT(mean_difference(small, expected), 8) << orientation;
    const Bytes png = test::with_png_exif(test::encode(".png", flag(320, 240)), test::exif_block(orientation, false));
    EXPECT_LT(mean_difference(shrunk(png, 120), expected), 8) << orientation;
    // As it is, but not as it lies.
    EXPECT_EQ(shrunk(png, 4000).size(), orientation == 1 ? cv::Size() : seen.size()) << orientation;
  }
}

TEST(Shrink, KeepsTransparencyAndTakesEveryDepth) {
  cv::Mat bgra;
  cv::cvtColor(flag(200, 100), bgra, cv::COLOR_BGR2BGRA);
  bgra.colRange(0, 100).forEach<cv::Vec4b>([](cv::Vec4b& pixel, const int*) { pixel[3] = 0; });
  const cv::Mat small = shrunk(test::encode(".png", bgra), 50);
  ASSERT_EQ(small.type(), CV_8UC4);
  EXPECT_EQ(small.at<cv::Vec4b>(20, 5)[3], 0);
  EXPECT_EQ(small.at<cv::Vec4b>(20, 45)[3], 255);
  const cv::Mat deep(100, 200, CV_16UC1, cv::Scalar(257 * 77));
  EXPECT_EQ(shrunk(test::encode(".png", deep), 50).at<std::uint8_t>(3, 3), 77);
  EXPECT_EQ(shrunk(test::encode(".jpg", cv::Mat(100, 200, CV_8UC1, cv::Scalar(40))), 50).channels(), 1);
  const Bytes cmyk = test::encode_jpeg(flag(200, 100), {.colours = test::JpegColours::kYcck});
  EXPECT_LT(mean_difference(shrunk(cmyk, 50), flag(50, 25)), 20);
}

// A text of a PNG that inflates without end is not read.
TEST(Shrink, ReadsPixelsAlone) {
  const Bytes png = test::encode(".png", flag(100, 100));
  Bytes text = {'x', 0, 0};
  text.resize(1000, 0x55);  // what follows is no stream at all
  const Bytes with_text = test::with_png_chunk(png, test::png_chunk("zTXt", text));
  EXPECT_EQ(shrink_image(with_text, 50), shrink_image(png, 50));
}

TEST(Shrink, RefusesWhatDecodingRefuses) {
  const auto code = [](const Bytes& file) -> std::string {
    try {
      shrink_image(file, 16);
      return "none";
    } catch (const ImageError& error) {
      return error.code();
    }
  };
  EXPECT_EQ(code({}), "empty_body");
  EXPECT_EQ(code({'G', 'I', 'F', '8', '9', 'a'}), "unsupported_image");
  EXPECT_EQ(code(test::png_claiming(5000, 5000)), "image_too_large");
  EXPECT_EQ(code(test::png_claiming(500, 500)), "undecodable_image");
  const Bytes png = test::encode(".png", flag(100, 100));
  EXPECT_EQ(code(Bytes(png.begin(), png.begin() + 60)), "undecodable_image");
}

}  // namespace
}  // namespace mapweld
