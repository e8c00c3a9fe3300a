// PNG files of every kind that the format knows, made for tests.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tests/core/feature/image_files.h"

namespace mapweld::test {

enum class PngColour : std::uint8_t { kGrey, kRgb, kPalette, kGreyAlpha, kRgba };

struct PngLayout {
  int width_px = 0;
  int height_px = 0;
  PngColour colour = PngColour::kGrey;
  int bits = 8;  // a sample: 1, 2, 4, 8, 16 where the colour allows it
  bool interlaced = false;
  std::vector<std::array<std::uint8_t, 3>> palette = {};
  std::vector<std::uint8_t> palette_alpha = {};                  // a tRNS chunk: of the palette's first colours
  std::optional<std::array<std::uint16_t, 3>> transparent = {};  // a tRNS chunk: this grey (its first number) or colour
};

// The samples of a pixel as they are stored: grey or the index, the alpha; or red, green, blue and alpha.
using PngSamples = std::function<std::array<std::uint16_t, 4>(int x, int y)>;

Bytes encode_png(const PngLayout& layout, const PngSamples& samples);

}  // namespace mapweld::test
