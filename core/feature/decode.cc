#include "core/feature/decode.h"

#include <algorithm>
#include <array>
#include <string>

#include <opencv2/core.hpp>

#include "core/errors.h"
#include "core/feature/contrast.h"
#include "core/feature/exif.h"
#include "core/feature/jpeg.h"
#include "core/feature/png.h"

namespace mapweld {
namespace {

constexpr std::array<std::uint8_t, 3> kJpegMagic = {0xFF, 0xD8, 0xFF};
constexpr std::array<std::uint8_t, 8> kPngMagic = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::array<std::uint8_t, 8> kPngHeaderChunk = {0, 0, 0, 13, 'I', 'H', 'D', 'R'};

template <std::size_t N>
bool starts_with(std::span<const std::uint8_t> bytes, const std::array<std::uint8_t, N>& magic) {
  return bytes.size() >= N && std::equal(magic.begin(), magic.end(), bytes.begin());
}

ImageHeader::Format read_format(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) throw ImageError("empty_body", "The image has no bytes.");
  if (starts_with(bytes, kJpegMagic)) return ImageHeader::Format::kJpeg;
  if (starts_with(bytes, kPngMagic)) return ImageHeader::Format::kPng;
  throw ImageError("unsupported_image", "Only JPEG and PNG are taken; the first bytes are of neither.");
}

ImageHeader read_png_header(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kSizeAt = kPngMagic.size() + kPngHeaderChunk.size();
  const std::span<const std::uint8_t> chunk = bytes.subspan(kPngMagic.size());
  if (bytes.size() < kSizeAt + 8 || !starts_with(chunk, kPngHeaderChunk)) {
    throw ImageError("undecodable_image", "PNG: the header is cut short or missing.");
  }
  const auto number = [&](std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 | std::uint32_t{bytes[at + 2]} << 8 |
           std::uint32_t{bytes[at + 3]};
  };
  const std::uint32_t width = number(kSizeAt);
  const std::uint32_t height = number(kSizeAt + 4);
  if (width == 0 || height == 0 || width > INT32_MAX || height > INT32_MAX) {
    throw ImageError("undecodable_image", "PNG: width or height is out of range.");
  }
  return {ImageHeader::Format::kPng, static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace

ImageHeader read_image_header(std::span<const std::uint8_t> bytes) {
  if (read_format(bytes) == ImageHeader::Format::kPng) return read_png_header(bytes);
  const JpegReader reader(bytes);
  return {ImageHeader::Format::kJpeg, reader.width_px(), reader.height_px()};
}

void refuse_large(const ImageHeader& header, const DecodeOptions& options) {
  const std::int64_t pixels = std::int64_t{header.width_px} * header.height_px;
  if (std::max(header.width_px, header.height_px) > options.max_side_px || pixels > options.max_pixels) {
    throw ImageError("image_too_large", "The image has " + std::to_string(header.width_px) + "x" +
                                            std::to_string(header.height_px) + " pixels; at most " +
                                            std::to_string(options.max_pixels) + " and " +
                                            std::to_string(options.max_side_px) + " a side are taken.");
  }
}

DecodedImage decode_image(std::span<const std::uint8_t> bytes, const DecodeOptions& options) {
  DecodedImage image;
  if (read_format(bytes) == ImageHeader::Format::kPng) {
    image.format = ImageHeader::Format::kPng;
    const ImageHeader header = read_png_header(bytes);
    refuse_large(header, options);
    const PngImage png = read_png_grey(bytes);
    image.grey = upright(png.grey, png.orientation);
    if (!png.used.empty()) image.used = upright(png.used, png.orientation);
  } else {
    JpegReader reader(bytes);
    refuse_large({ImageHeader::Format::kJpeg, reader.width_px(), reader.height_px()}, options);
    image.grey = upright(reader.read_grey(), reader.orientation());
  }
  image.grey = options.stretch ? stretched_to_8_bits(image.grey, image.used) : scaled_to_8_bits(image.grey);
  return image;
}

cv::Mat decode_grey(std::span<const std::uint8_t> bytes, const DecodeOptions& options) {
  return decode_image(bytes, options).grey;
}

}  // namespace mapweld
