// PNG and JPEG of the kinds that users send and few programs write.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/feature/decode.h"
#include "tests/core/feature/image_files.h"
#include "tests/core/feature/png_files.h"

namespace mapweld {
namespace {

using test::Bytes;
using test::PngColour;
using test::PngLayout;

constexpr int kWidth = 37;  // no multiple of 8: rows of fewer bits end within a byte
constexpr int kHeight = 21;

// What a sample is worth in levels of 8 bits.
double level(std::uint16_t sample, int bits) { return 255.0 * sample / ((1 << bits) - 1); }

double luma(double red, double green, double blue) { return 0.299 * red + 0.587 * green + 0.114 * blue; }

std::array<std::uint16_t, 4> some_samples(int x, int y, int bits) {
  const auto sample = [&](unsigned seed) {
    return static_cast<std::uint16_t>(
        (seed * 40503u + static_cast<unsigned>(x) * 977u + static_cast<unsigned>(y) * 3251u) & ((1u << bits) - 1));
  };
  return {sample(1), sample(7), sample(19), sample(31)};
}

struct Kind {
  PngColour colour;
  std::vector<int> bits;
};
const std::vector<Kind> kKinds = {{PngColour::kGrey, {1, 2, 4, 8, 16}},
                                  {PngColour::kRgb, {8, 16}},
                                  {PngColour::kPalette, {1, 2, 4, 8}},
                                  {PngColour::kGreyAlpha, {8, 16}},
                                  {PngColour::kRgba, {8, 16}}};

// Colours that differ in every channel; a palette of all indices.
std::vector<std::array<std::uint8_t, 3>> palette_of(int bits) {
  std::vector<std::array<std::uint8_t, 3>> palette;
  for (int i = 0; i < 1 << bits; ++i) {
    palette.push_back(
        {static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(i * 13)});
  }
  return palette;
}

std::string said(const PngLayout& layout) {
  return "colour " + std::to_string(static_cast<int>(layout.colour)) + ", " + std::to_string(layout.bits) + " bits" +
         (layout.interlaced ? ", interlaced" : "");
}

TEST(OddPng, EveryColourTypeAndDepth) {
  for (const Kind& kind : kKinds) {
    for (const int bits : kind.bits) {
      for (const bool interlaced : {false, true}) {
        PngLayout layout{
            .width_px = kWidth, .height_px = kHeight, .colour = kind.colour, .bits = bits, .interlaced = interlaced};
        const auto palette = palette_of(bits <= 8 ? bits : 1);
        if (kind.colour == PngColour::kPalette) layout.palette = palette;
        const auto samples = [&](int x, int y) { return some_samples(x, y, bits); };
        const DecodedImage image = decode_image(test::encode_png(layout, samples), {.stretch = false});
        ASSERT_EQ(image.grey.size(), cv::Size(kWidth, kHeight)) << said(layout);
        ASSERT_EQ(image.grey.type(), CV_8UC1);
        bool has_hole = false;
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) {
            const auto s = samples(x, y);
            double expected = level(s[0], bits);
            bool used = true;
            if (kind.colour == PngColour::kRgb || kind.colour == PngColour::kRgba) {
              expected = luma(level(s[0], bits), level(s[1], bits), level(s[2], bits));
              used = kind.colour == PngColour::kRgb || s[3] != 0;
            } else if (kind.colour == PngColour::kPalette) {
              const auto& colour = palette[s[0]];
              expected = luma(colour[0], colour[1], colour[2]);
            } else if (kind.colour == PngColour::kGreyAlpha) {
              used = s[1] != 0;
            }
            EXPECT_NEAR(image.grey.at<std::uint8_t>(y, x), expected, 1.01) << said(layout) << ' ' << x << ' ' << y;
            EXPECT_EQ(image.used.empty() || image.used.at<std::uint8_t>(y, x) != 0, used) << said(layout);
            has_hole = has_hole || !used;
          }
        }
        EXPECT_EQ(image.used.empty(), !has_hole) << said(layout);
      }
    }
  }
}

TEST(OddPng, APaletteWithTransparency) {
  for (const int bits : {1, 2, 4, 8}) {
    PngLayout layout{.width_px = kWidth, .height_px = kHeight, .colour = PngColour::kPalette, .bits = bits};
    layout.palette = palette_of(bits);
    layout.palette_alpha = {255, 0};  // the others are opaque
    const auto index = [&](int x, int y) { return some_samples(x, y, bits)[0]; };
    const DecodedImage image =
        decode_image(test::encode_png(layout, [&](int x, int y) { return std::array<std::uint16_t, 4>{index(x, y)}; }),
                     {.stretch = false});
    ASSERT_FALSE(image.used.empty());
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        EXPECT_EQ(image.used.at<std::uint8_t>(y, x) != 0, index(x, y) != 1);
        const auto& colour = layout.palette[index(x, y)];
        EXPECT_NEAR(image.grey.at<std::uint8_t>(y, x), luma(colour[0], colour[1], colour[2]), 1.01);
      }
    }
  }
}

TEST(OddPng, OneGreyOrColourThatIsTransparent) {
  for (const Kind& kind : {Kind{PngColour::kGrey, {1, 2, 4, 8, 16}}, Kind{PngColour::kRgb, {8, 16}}}) {
    for (const int bits : kind.bits) {
      PngLayout layout{.width_px = kWidth, .height_px = kHeight, .colour = kind.colour, .bits = bits};
      const auto key = some_samples(5, 6, bits);
      layout.transparent = {key[0], key[1], key[2]};
      const auto samples = [&](int x, int y) { return some_samples(x, y, bits); };
      const DecodedImage image = decode_image(test::encode_png(layout, samples), {.stretch = false});
      ASSERT_FALSE(image.used.empty());
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const auto s = samples(x, y);
          const bool is_key = s[0] == key[0] && (kind.colour == PngColour::kGrey || (s[1] == key[1] && s[2] == key[2]));
          EXPECT_EQ(image.used.at<std::uint8_t>(y, x) == 0, is_key) << said(layout) << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST(OddPng, TransparencyTurnsWithTheImage) {
  PngLayout layout{.width_px = 6, .height_px = 4, .colour = PngColour::kGreyAlpha};
  const Bytes png = test::encode_png(layout, [](int x, int y) {
    return std::array<std::uint16_t, 4>{static_cast<std::uint16_t>(40 * x),
                                        static_cast<std::uint16_t>(x == 5 && y == 0 ? 0 : 255)};
  });
  const DecodedImage image = decode_image(test::with_png_exif(png, test::exif_block(6, false)));  // a quarter clockwise
  ASSERT_EQ(image.used.size(), cv::Size(4, 6));
  EXPECT_EQ(cv::countNonZero(image.used == 0), 1);
  EXPECT_EQ(image.used.at<std::uint8_t>(5, 3), 0) << "the upper right corner comes to the lower right";
}

TEST(OddPng, ChunksThatSayLittleAboutPixelsChangeNothing) {
  cv::Mat grey;
  cv::cvtColor(test::textured_image(60, 40), grey, cv::COLOR_BGR2GRAY);
  const Bytes png = test::encode(".png", grey);
  const std::vector<std::pair<std::string, Bytes>> chunks = {
      {"gAMA", {0, 0, 0xB1, 0x8F}},  // 1 / 2.2
      {"gAMA", {0, 0, 0, 0}},        // none that there is
      {"sBIT", {5}},
      {"sBIT", {99, 1, 2}},
      {"sRGB", {0}},
      {"iCCP", {'p', 0, 0, 1, 2, 3}},  // a profile that cannot be unpacked
      {"cHRM", {1, 2, 3}},
      {"pHYs", {0, 0, 0, 1, 0, 0, 0, 1, 0}},
      {"tEXt", {'C', 'o', 'm', 'm', 'e', 'n', 't', 0, 'x'}},
      {"tIME", {0, 0, 99, 99, 99, 99, 99}},
      {"oDDs", {1, 2, 3}},  // of some program's own
  };
  for (const auto& [type, data] : chunks) {
    const DecodedImage image = decode_image(test::with_png_chunk(png, test::png_chunk(type, data)));
    EXPECT_EQ(cv::norm(image.grey, grey, cv::NORM_INF), 0) << type;
  }
  Bytes spoilt = test::png_chunk("tEXt", Bytes{'a', 0, 'b'});
  spoilt.back() ^= 1;
  EXPECT_EQ(cv::norm(decode_grey(test::with_png_chunk(png, spoilt)), grey, cv::NORM_INF), 0)
      << "the checksum of a text is nobody's loss";
}

TEST(OddJpeg, EveryColourSpaceAndCoding) {
  const cv::Mat image = test::textured_image(120, 80);
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  using test::JpegColours;
  for (const JpegColours colours : {JpegColours::kYcc, JpegColours::kRgb, JpegColours::kCmyk, JpegColours::kYcck}) {
    for (const bool progressive : {false, true}) {
      for (const bool arithmetic : {false, true}) {
        for (const unsigned restart_rows : {0u, 1u}) {
          const Bytes jpeg = test::encode_jpeg(
              image,
              {.colours = colours, .progressive = progressive, .arithmetic = arithmetic, .restart_rows = restart_rows});
          const cv::Mat decoded = decode_grey(jpeg);
          ASSERT_EQ(decoded.size(), grey.size());
          EXPECT_LE(cv::norm(decoded, grey, cv::NORM_INF), 8)
              << static_cast<int>(colours) << progressive << arithmetic << restart_rows;
          EXPECT_LE(cv::norm(decoded, grey, cv::NORM_L1) / static_cast<double>(grey.total()), 1);
        }
      }
    }
  }
}

// Frames of a webcam's MJPEG leave out the Huffman tables that everybody knows.
TEST(OddJpeg, WithoutItsHuffmanTables) {
  const cv::Mat image = test::textured_image(64, 48);
  Bytes jpeg = test::encode_jpeg(image, {});
  const cv::Mat whole = decode_grey(jpeg);
  int cut = 0;
  for (std::size_t at = 2; at + 4 < jpeg.size() && jpeg[at + 1] != 0xDA;) {
    const std::size_t length = 2 + (std::size_t{jpeg[at + 2]} << 8 | jpeg[at + 3]);
    const auto first = jpeg.begin() + static_cast<std::ptrdiff_t>(at);
    if (jpeg[at + 1] == 0xC4) {
      jpeg.erase(first, first + static_cast<std::ptrdiff_t>(length));
      ++cut;
    } else {
      at += length;
    }
  }
  ASSERT_GT(cut, 0);
  EXPECT_EQ(cv::norm(decode_grey(jpeg), whole, cv::NORM_INF), 0);
}

TEST(OddJpeg, WhatCannotBeReadSaysSo) {
  Bytes jpeg = test::encode_jpeg(test::textured_image(64, 48), {});
  for (std::size_t at = 2; at + 9 < jpeg.size(); ++at) {
    if (jpeg[at] == 0xFF && jpeg[at + 1] == 0xC0) {
      jpeg[at + 4] = 12;  // bits a sample
      break;
    }
  }
  try {
    decode_grey(jpeg);
    FAIL();
  } catch (const ImageError& error) {
    EXPECT_EQ(error.code(), "undecodable_image");
    EXPECT_NE(std::string(error.what()).find("12"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace mapweld
