#include "core/feature/shrink.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/feature/exif.h"
#include "core/feature/jpeg.h"

namespace mapweld {
namespace {

constexpr int kJpegQuality = 85;

struct Stored {
  std::vector<std::uint8_t> file;  // without what is not pixels
  int orientation = 1;
};

// Of a PNG only what its pixels are made of: texts and profiles, which may inflate to anything, are nobody's concern.
Stored pixels_of_png(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMagicBytes = 8;
  constexpr std::array<std::string_view, 5> kKept = {"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};
  Stored stored;
  stored.file.assign(bytes.begin(), bytes.begin() + kMagicBytes);
  for (std::size_t at = kMagicBytes; at + 12 <= bytes.size();) {
    const std::uint64_t data = std::uint64_t{bytes[at]} << 24 | std::uint64_t{bytes[at + 1]} << 16 |
                               std::uint64_t{bytes[at + 2]} << 8 | bytes[at + 3];
    if (data > bytes.size() - at - 12) break;
    const std::span<const std::uint8_t> chunk = bytes.subspan(at, 12 + data);
    const std::string_view type(reinterpret_cast<const char*>(chunk.data()) + 4, 4);
    if (std::ranges::find(kKept, type) != kKept.end())
      stored.file.insert(stored.file.end(), chunk.begin(), chunk.end());
    if (type == "eXIf") stored.orientation = read_exif_orientation(chunk.subspan(8, data));
    at += chunk.size();
  }
  return stored;
}

Stored read(std::span<const std::uint8_t> bytes, ImageHeader::Format format) {
  if (format == ImageHeader::Format::kPng) return pixels_of_png(bytes);
  return {{bytes.begin(), bytes.end()}, JpegReader(bytes).orientation()};
}

cv::Mat decode(const Stored& stored) {
  cv::Mat picture;
  try {
    picture = cv::imdecode(stored.file, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {  // told below
  }
  if (picture.empty()) throw ImageError("undecodable_image", "The image cannot be decoded.");
  if (picture.depth() == CV_16U) picture.convertTo(picture, CV_8U, 1.0 / 257);
  return upright(picture, stored.orientation);
}

}  // namespace

std::vector<std::uint8_t> shrink_image(std::span<const std::uint8_t> bytes, int width_px,
                                       const DecodeOptions& options) {
  const ImageHeader header = read_image_header(bytes);
  refuse_large(header, options);
  const Stored stored = read(bytes, header.format);
  if (stored.orientation == 1 && header.width_px <= width_px) return {};
  cv::Mat picture = decode(stored);
  if (picture.cols > width_px) {
    const double scale = static_cast<double>(width_px) / picture.cols;
    const int height_px = std::max(1, static_cast<int>(std::lround(picture.rows * scale)));
    cv::Mat smaller;
    cv::resize(picture, smaller, {width_px, height_px}, 0, 0, cv::INTER_AREA);
    picture = smaller;
  }
  std::vector<std::uint8_t> file;
  if (header.format == ImageHeader::Format::kPng) {
    cv::imencode(".png", picture, file);
  } else {
    cv::imencode(".jpg", picture, file, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  }
  return file;
}

}  // namespace mapweld
