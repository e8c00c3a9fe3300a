#include "tests/core/feature/png_files.h"

#include <cstddef>
#include <stdexcept>

#include <png.h>

namespace mapweld::test {
namespace {

int colour_type(PngColour colour) {
  switch (colour) {
    case PngColour::kGrey:
      return PNG_COLOR_TYPE_GRAY;
    case PngColour::kRgb:
      return PNG_COLOR_TYPE_RGB;
    case PngColour::kPalette:
      return PNG_COLOR_TYPE_PALETTE;
    case PngColour::kGreyAlpha:
      return PNG_COLOR_TYPE_GRAY_ALPHA;
    case PngColour::kRgba:
      return PNG_COLOR_TYPE_RGBA;
  }
  return 0;
}

std::size_t channels_of(PngColour colour) {
  switch (colour) {
    case PngColour::kGreyAlpha:
      return 2;
    case PngColour::kRgb:
      return 3;
    case PngColour::kRgba:
      return 4;
    default:
      return 1;
  }
}

void append(png_structp codec, png_bytep bytes, std::size_t count) {
  auto* file = static_cast<Bytes*>(png_get_io_ptr(codec));
  file->insert(file->end(), bytes, bytes + count);
}

[[noreturn]] void on_error(png_structp, png_const_charp text) { throw std::runtime_error(text); }

// One row as PNG packs it: samples one after the other, the first in the highest bits.
Bytes packed_row(const PngLayout& layout, const PngSamples& samples, int y) {
  Bytes row;
  unsigned pending = 0;
  int pending_bits = 0;
  for (int x = 0; x < layout.width_px; ++x) {
    const auto pixel = samples(x, y);
    for (std::size_t channel = 0; channel < channels_of(layout.colour); ++channel) {
      pending = pending << layout.bits | pixel[channel];
      pending_bits += layout.bits;
      for (; pending_bits >= 8; pending_bits -= 8)
        row.push_back(static_cast<std::uint8_t>(pending >> (pending_bits - 8)));
    }
  }
  if (pending_bits > 0) row.push_back(static_cast<std::uint8_t>(pending << (8 - pending_bits)));
  return row;
}

}  // namespace

Bytes encode_png(const PngLayout& layout, const PngSamples& samples) {
  Bytes file;
  png_structp codec = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, nullptr);
  png_infop info = png_create_info_struct(codec);
  png_set_write_fn(codec, &file, append, nullptr);
  png_set_IHDR(codec, info, static_cast<png_uint_32>(layout.width_px), static_cast<png_uint_32>(layout.height_px),
               layout.bits, colour_type(layout.colour), layout.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  for (const auto& colour : layout.palette) palette.push_back({colour[0], colour[1], colour[2]});
  if (!palette.empty()) png_set_PLTE(codec, info, palette.data(), static_cast<int>(palette.size()));
  if (!layout.palette_alpha.empty()) {
    png_set_tRNS(codec, info, layout.palette_alpha.data(), static_cast<int>(layout.palette_alpha.size()), nullptr);
  }
  if (layout.transparent) {
    const auto& key = *layout.transparent;
    const png_color_16 colour{0, key[0], key[1], key[2], key[0]};
    png_set_tRNS(codec, info, nullptr, 0, &colour);
  }
  png_write_info(codec, info);
  std::vector<Bytes> rows;
  std::vector<png_bytep> pointers;
  for (int y = 0; y < layout.height_px; ++y) rows.push_back(packed_row(layout, samples, y));
  for (Bytes& row : rows) pointers.push_back(row.data());
  png_write_image(codec, pointers.data());
  png_write_end(codec, info);
  png_destroy_write_struct(&codec, &info);
  return file;
}

}  // namespace mapweld::test
