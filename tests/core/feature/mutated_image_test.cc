// Thousands of image files with bytes changed, cut out and put in: whatever arrives, it becomes pixels or an
// ImageError.
#include <algorithm>
#include <array>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/errors.h"
#include "core/feature/decode.h"
#include "core/random.h"
#include "tests/core/feature/image_files.h"
#include "tests/core/feature/png_files.h"

namespace mapweld {
namespace {

using test::Bytes;

constexpr int kMutations = 10'000;

// Values at which parsers break.
constexpr std::uint8_t kNasty[] = {0x00, 0x01, 0x7F, 0x80, 0xFE, 0xFF, 0xD8, 0xD9, 0xDA, 0xC2};

void mutate(Bytes& file, SplitMix64& random) {
  const int edits = 1 + static_cast<int>(random.below(4));
  for (int i = 0; i < edits && file.size() > 16; ++i) {
    // Half of the edits hit the head, where the structure is.
    const std::size_t reach = random.below(2) == 0 ? std::min<std::size_t>(file.size(), 700) : file.size();
    const std::size_t at = random.below(reach);
    const std::size_t length = std::min<std::size_t>(1 + random.below(40), file.size() - at);
    const auto first = file.begin() + static_cast<std::ptrdiff_t>(at);
    switch (random.below(6)) {
      case 0:
        file[at] = static_cast<std::uint8_t>(random.below(256));
        break;
      case 1:
        file[at] ^= static_cast<std::uint8_t>(1u << random.below(8));
        break;
      case 2:
        file[at] = kNasty[random.below(std::size(kNasty))];
        break;
      case 3:
        file.erase(first, first + static_cast<std::ptrdiff_t>(length));
        break;
      case 4: {
        const Bytes piece(first, first + static_cast<std::ptrdiff_t>(length));
        const auto to = static_cast<std::ptrdiff_t>(random.below(file.size()));
        file.insert(file.begin() + to, piece.begin(), piece.end());
        break;
      }
      default:
        file.resize(8 + random.below(file.size() - 8));
        break;
    }
  }
}

TEST(MutatedImages, BecomePixelsOrAnError) {
  const cv::Mat image = test::textured_image(48, 40);
  cv::Mat black_and_white;
  cv::extractChannel(image > 128, black_and_white, 0);
  const Bytes exif = test::exif_block(6, false);
  const test::PngLayout palette{.width_px = 48,
                                .height_px = 40,
                                .colour = test::PngColour::kPalette,
                                .bits = 2,
                                .interlaced = true,
                                .palette = {{0, 0, 0}, {90, 0, 0}, {0, 90, 0}, {255, 255, 255}},
                                .palette_alpha = {0, 255, 128}};
  const Bytes originals[] = {
      test::with_jpeg_exif(test::encode(".jpg", image), exif),
      test::encode(".jpg", image, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2}),
      test::encode_jpeg(image, {.colours = test::JpegColours::kCmyk}),
      test::with_png_exif(test::encode(".png", image), exif),
      test::encode(".png", black_and_white, {cv::IMWRITE_PNG_BILEVEL, 1}),
      test::encode_png(
          palette, [](int x, int y) { return std::array<std::uint16_t, 4>{static_cast<std::uint16_t>((x + y) % 4)}; }),
  };
  DecodeOptions options;
  options.max_pixels = 1'000'000;  // so that a header's lie costs no time
  SplitMix64 random(2011);
  int decoded = 0;
  int refused = 0;
  for (int i = 0; i < kMutations; ++i) {
    Bytes file = originals[random.below(std::size(originals))];
    mutate(file, random);
    try {
      const DecodedImage decoded_image = decode_image(file, options);
      EXPECT_EQ(decoded_image.grey.type(), CV_8UC1);
      EXPECT_FALSE(decoded_image.grey.empty());
      EXPECT_TRUE(decoded_image.used.empty() || decoded_image.used.size() == decoded_image.grey.size());
      ++decoded;
    } catch (const ImageError& error) {
      EXPECT_TRUE(error.code() == "undecodable_image" || error.code() == "unsupported_image" ||
                  error.code() == "image_too_large")
          << error.code();
      ++refused;
    }
  }
  EXPECT_GT(decoded, kMutations / 20) << "the mutations are too rough to reach the decoders";
  EXPECT_GT(refused, kMutations / 20) << "the mutations are too gentle to test anything";
}

}  // namespace
}  // namespace mapweld
