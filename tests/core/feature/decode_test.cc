#include "core/feature/decode.h"

#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "tests/core/feature/image_files.h"

namespace mapweld {
namespace {

using test::Bytes;

std::string code_of(const Bytes& bytes) {
  try {
    decode_grey(bytes);
  } catch (const ImageError& error) {
    return error.code();
  }
  return "decoded";
}

// The pixels as the file has them.
cv::Mat stored_grey(const Bytes& bytes) { return decode_image(bytes, {.stretch = false}).grey; }

double largest_difference(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(a.size(), b.size());
  return a.size() == b.size() ? cv::norm(a, b, cv::NORM_INF) : 1e9;
}

cv::Mat grey_of(const cv::Mat& bgr) {
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

TEST(Decode, JpegAsOpenCvDecodesIt) {
  const cv::Mat image = test::textured_image(123, 77);
  for (const int progressive : {0, 1}) {
    const Bytes bytes = test::encode(".jpg", image, {cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
    EXPECT_EQ(largest_difference(stored_grey(bytes), cv::imdecode(bytes, cv::IMREAD_GRAYSCALE)), 0);
  }
}

TEST(Decode, PngLosesNothing) {
  const cv::Mat image = test::textured_image(123, 77);
  EXPECT_EQ(largest_difference(stored_grey(test::encode(".png", image)), grey_of(image)), 0);
  EXPECT_EQ(largest_difference(stored_grey(test::encode(".png", grey_of(image))), grey_of(image)), 0);
}

TEST(Decode, TakesOneBitPng) {
  const cv::Mat black_and_white = grey_of(test::textured_image(40, 30)) > 128;
  const Bytes bytes = test::encode(".png", black_and_white, {cv::IMWRITE_PNG_BILEVEL, 1});
  EXPECT_EQ(largest_difference(stored_grey(bytes), black_and_white), 0);
}

TEST(Decode, SixteenBitsAreScaledToEight) {
  const cv::Mat image = grey_of(test::textured_image(60, 40));
  cv::Mat wide;
  image.convertTo(wide, CV_16U, 257);
  EXPECT_EQ(largest_difference(stored_grey(test::encode(".png", wide)), image), 0);
}

TEST(Decode, TransparencyIsIgnored) {
  const cv::Mat image = test::textured_image(60, 40);
  cv::Mat with_alpha;
  cv::cvtColor(image, with_alpha, cv::COLOR_BGR2BGRA);
  for (int y = 0; y < with_alpha.rows; ++y) with_alpha.at<cv::Vec4b>(y, y)[3] = 0;
  EXPECT_EQ(largest_difference(stored_grey(test::encode(".png", with_alpha)), grey_of(image)), 0);
}

TEST(Decode, TakesCmykJpeg) {
  const cv::Mat image = test::textured_image(120, 80);
  const cv::Mat grey = stored_grey(test::encode_jpeg(image, {.colours = test::JpegColours::kCmyk}));
  EXPECT_LE(largest_difference(grey, grey_of(image)), 6);
}

TEST(Decode, TakesOnePixel) {
  const cv::Mat pixel(1, 1, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(largest_difference(stored_grey(test::encode(".png", pixel)), pixel), 0);
  EXPECT_LE(largest_difference(stored_grey(test::encode(".jpg", pixel)), pixel), 2);
}

TEST(Decode, OfAnAnimationTheFirstFrame) {
  const cv::Mat image = grey_of(test::textured_image(32, 24));
  Bytes bytes = test::encode(".png", image);
  const Bytes frames{0, 0, 0, 2, 0, 0, 0, 0};
  bytes = test::with_png_chunk(bytes, test::png_chunk("acTL", frames));
  // A second frame in front of the end: sequence number 1 and pixels that must not be looked at.
  const Bytes frame{0, 0, 0, 1, 1, 2, 3, 4};
  const Bytes chunk = test::png_chunk("fdAT", frame);
  bytes.insert(bytes.end() - 12, chunk.begin(), chunk.end());
  EXPECT_EQ(largest_difference(stored_grey(bytes), image), 0);
}

// The EXIF standard: the visual sides on which row 0 and column 0 of the stored image lie.
struct Sides {
  char row0;
  char column0;
};
constexpr Sides kSides[] = {{'t', 'l'}, {'t', 'r'}, {'b', 'r'}, {'b', 'l'},
                            {'l', 't'}, {'r', 't'}, {'r', 'b'}, {'l', 'b'}};

cv::Mat as_seen(const cv::Mat& stored, int orientation) {
  const Sides sides = kSides[orientation - 1];
  const bool upright = sides.row0 == 't' || sides.row0 == 'b';
  cv::Mat seen(upright ? stored.rows : stored.cols, upright ? stored.cols : stored.rows, CV_8UC1);
  for (int row = 0; row < stored.rows; ++row) {
    for (int column = 0; column < stored.cols; ++column) {
      int x = 0;
      int y = 0;
      for (const auto& [side, along] : {std::pair(sides.row0, row), std::pair(sides.column0, column)}) {
        if (side == 't') y = along;
        if (side == 'b') y = seen.rows - 1 - along;
        if (side == 'l') x = along;
        if (side == 'r') x = seen.cols - 1 - along;
      }
      seen.at<std::uint8_t>(y, x) = stored.at<std::uint8_t>(row, column);
    }
  }
  return seen;
}

TEST(Decode, OrientationIsAppliedOnce) {
  const cv::Mat image = grey_of(test::textured_image(24, 16));
  const Bytes png = test::encode(".png", image);
  const Bytes jpeg = test::encode(".jpg", image);
  const cv::Mat jpeg_pixels = stored_grey(jpeg);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    for (const bool big_endian : {false, true}) {
      const Bytes exif = test::exif_block(orientation, big_endian);
      EXPECT_EQ(largest_difference(stored_grey(test::with_png_exif(png, exif)), as_seen(image, orientation)), 0);
      const Bytes turned = test::with_jpeg_exif(jpeg, exif);
      EXPECT_EQ(largest_difference(stored_grey(turned), as_seen(jpeg_pixels, orientation)), 0) << orientation;
      EXPECT_EQ(largest_difference(stored_grey(turned), cv::imdecode(turned, cv::IMREAD_GRAYSCALE)), 0) << orientation;
      EXPECT_EQ(read_image_header(turned).width_px, 24) << "a header tells the size as stored";
    }
  }
}

TEST(Decode, BrokenExifSpoilsNothing) {
  const Bytes jpeg = test::encode(".jpg", test::textured_image(24, 16));
  const Bytes whole = test::exif_block(6, false);
  for (std::size_t size = 0; size < whole.size() - 6; ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(stored_grey(test::with_jpeg_exif(jpeg, cut)).cols, 24) << size;
  }
  for (const int orientation : {0, 9, 255}) {
    EXPECT_EQ(stored_grey(test::with_jpeg_exif(jpeg, test::exif_block(orientation, true))).cols, 24);
  }
}

TEST(Decode, HeadersTellFormatAndSize) {
  const cv::Mat image = test::textured_image(31, 17);
  const ImageHeader jpeg = read_image_header(test::encode(".jpg", image));
  EXPECT_EQ(jpeg.format, ImageHeader::Format::kJpeg);
  EXPECT_EQ(jpeg.width_px, 31);
  EXPECT_EQ(jpeg.height_px, 17);
  const ImageHeader png = read_image_header(test::encode(".png", image));
  EXPECT_EQ(png.format, ImageHeader::Format::kPng);
  EXPECT_EQ(png.width_px, 31);
  EXPECT_EQ(png.height_px, 17);
}

TEST(Decode, NothingIsEmptyBody) { EXPECT_EQ(code_of({}), "empty_body"); }

TEST(Decode, OtherBytesAreUnsupported) {
  const std::string text = "These are words, not pixels.";
  EXPECT_EQ(code_of({text.begin(), text.end()}), "unsupported_image");
  EXPECT_EQ(code_of({'G', 'I', 'F', '8', '9', 'a', 1, 0, 1, 0, 0, 0, 0}), "unsupported_image");
  EXPECT_EQ(code_of(test::encode(".bmp", test::textured_image(8, 8))), "unsupported_image");
  EXPECT_EQ(code_of(test::encode(".tiff", test::textured_image(8, 8))), "unsupported_image");
  EXPECT_EQ(code_of({'N', 'I', 'T', 'F', '0', '2', '.', '1', '0'}), "unsupported_image");
}

TEST(Decode, LargeImagesAreRefusedByTheirHeader) {
  EXPECT_EQ(code_of(test::png_claiming(20'000, 20'000)), "image_too_large");
  EXPECT_EQ(code_of(test::png_claiming(8193, 1)), "image_too_large");
  EXPECT_EQ(code_of(test::png_claiming(1, 8193)), "image_too_large");
  EXPECT_EQ(code_of(test::png_claiming(4001, 4000)), "image_too_large");
  EXPECT_EQ(code_of(test::png_claiming(0x7FFFFFFF, 0x7FFFFFFF)), "image_too_large");
  EXPECT_EQ(code_of(test::png_claiming(4000, 4000)), "undecodable_image") << "allowed, but it has no pixels";
  const Bytes jpeg = test::encode(".jpg", test::textured_image(64, 48));
  EXPECT_EQ(code_of(test::jpeg_claiming(jpeg, 20'000, 20'000)), "image_too_large");
  EXPECT_EQ(code_of(test::jpeg_claiming(jpeg, 64, 8193)), "image_too_large");
}

TEST(Decode, ImpossibleSizesAreUndecodable) {
  EXPECT_EQ(code_of(test::png_claiming(0, 5)), "undecodable_image");
  EXPECT_EQ(code_of(test::png_claiming(0xFFFFFFFF, 5)), "undecodable_image");
  const Bytes jpeg = test::encode(".jpg", test::textured_image(64, 48));
  EXPECT_EQ(code_of(test::jpeg_claiming(jpeg, 0, 48)), "undecodable_image");
  EXPECT_EQ(code_of(test::jpeg_claiming(jpeg, 64, 96)), "undecodable_image") << "half of the pixels are missing";
}

TEST(Decode, EveryTruncationIsNoticed) {
  const cv::Mat image = test::textured_image(96, 64);
  const Bytes files[] = {test::encode(".jpg", image), test::encode(".jpg", image, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
                         test::encode(".png", image)};
  for (const Bytes& file : files) {
    ASSERT_EQ(code_of(file), "decoded");
    for (std::size_t size = 8; size < file.size(); size += size + 40 < file.size() ? 37 : 1) {
      const Bytes cut(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_EQ(code_of(cut), "undecodable_image") << size << " of " << file.size();
    }
  }
}

TEST(Decode, BytesBehindTheImageAreIgnored) {
  const cv::Mat image = test::textured_image(96, 64);
  for (const char* ending : {".jpg", ".png"}) {
    Bytes file = test::encode(ending, image);
    const cv::Mat grey = stored_grey(file);
    file.insert(file.end(), 1000, 0xAB);
    EXPECT_EQ(largest_difference(stored_grey(file), grey), 0) << ending;
  }
}

TEST(Decode, ScansWithoutEndAreRefused) {
  const Bytes jpeg = test::encode(".jpg", test::textured_image(16, 16), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  // The last scan, once more and once more.
  std::size_t scan = 0;
  for (std::size_t i = 0; i + 1 < jpeg.size(); ++i) {
    if (jpeg[i] == 0xFF && jpeg[i + 1] == 0xDA) scan = i;
  }
  ASSERT_GT(scan, 0u);
  const Bytes again(jpeg.begin() + static_cast<std::ptrdiff_t>(scan), jpeg.end() - 2);
  Bytes bomb(jpeg.begin(), jpeg.end() - 2);
  for (int i = 0; i < 500; ++i) bomb.insert(bomb.end(), again.begin(), again.end());
  bomb.insert(bomb.end(), {0xFF, 0xD9});
  EXPECT_EQ(code_of(bomb), "undecodable_image");
}

TEST(Decode, AChecksumThatDoesNotHoldIsNoticed) {
  Bytes png = test::encode(".png", test::textured_image(96, 64));
  png[png.size() / 2] ^= 0x10;
  EXPECT_EQ(code_of(png), "undecodable_image");
}

}  // namespace
}  // namespace mapweld
