// From the bytes of an image file to a grey image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

namespace mapweld {

struct DecodeOptions {
  std::int64_t max_pixels = 16'000'000;  // refused by the header, before anything is decoded
  int max_side_px = 8192;
  bool stretch = true;  // a narrow range of values, see core/feature/contrast.h; false: 16 bits are only scaled to 8
};

struct ImageHeader {
  enum class Format : std::uint8_t { kJpeg, kPng } format = Format::kJpeg;
  int width_px = 0;  // as stored, before EXIF orientation
  int height_px = 0;
};

// Reads format and size from the first bytes of a JPEG or PNG.
// Throws ImageError: empty_body, unsupported_image, undecodable_image (a header cut short).
ImageHeader read_image_header(std::span<const std::uint8_t> bytes);

// Throws ImageError image_too_large.
void refuse_large(const ImageHeader& header, const DecodeOptions& options);

struct DecodedImage {
  ImageHeader::Format format = ImageHeader::Format::kJpeg;
  cv::Mat grey;  // CV_8UC1
  cv::Mat
      used;  // CV_8UC1 of the same size: 0 where the picture is wholly transparent, else 255; empty: all of it is used
};

// Decodes a JPEG or PNG to 8-bit grey, EXIF orientation applied once, a narrow range of values stretched. 16-bit, CMYK,
// 1x1 images and the first frame of an animation are taken. Thread-safe. Throws ImageError: as read_image_header, and
// image_too_large (by the header), undecodable_image (truncated, corrupt).
DecodedImage decode_image(std::span<const std::uint8_t> bytes, const DecodeOptions& options = {});

// Its grey alone.
cv::Mat decode_grey(std::span<const std::uint8_t> bytes, const DecodeOptions& options = {});

}  // namespace mapweld
