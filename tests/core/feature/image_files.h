// Image files made for tests: encoders for what users send, well-formed and not.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace mapweld::test {

using Bytes = std::vector<std::uint8_t>;

// A textured colour image: smooth blobs at seeded places, so that SIFT finds features and JPEG loses little.
cv::Mat textured_image(int width_px, int height_px, std::uint64_t seed = 1);

Bytes encode(std::string_view ending, const cv::Mat& image, const std::vector<int>& parameters = {});

enum class JpegColours : std::uint8_t { kYcc, kRgb, kCmyk, kYcck };

struct JpegLayout {
  JpegColours colours = JpegColours::kYcc;  // four inks as Adobe's programs write them: inverted, with their marker
  bool progressive = false;
  int scans = 0;  // of a progressive file, up to 64: the first coefficients and then one each; 0: the library's choice
  bool arithmetic = false;    // arithmetic coding in place of Huffman's
  unsigned restart_rows = 0;  // a restart marker every so many rows of blocks
};

// Of the best quality, colours not subsampled.
Bytes encode_jpeg(const cv::Mat& bgr, const JpegLayout& layout);

// An EXIF block (TIFF) that holds an orientation.
Bytes exif_block(int orientation, bool big_endian);
// The file with the block where readers look for it: an APP1 segment, an eXIf chunk.
Bytes with_jpeg_exif(const Bytes& jpeg, const Bytes& exif);
Bytes with_png_exif(const Bytes& png, const Bytes& exif);

// A PNG chunk with its checksum.
Bytes png_chunk(std::string_view type, std::span<const std::uint8_t> data);
// The file with a chunk right behind IHDR.
Bytes with_png_chunk(const Bytes& png, const Bytes& chunk);
// A PNG whose header claims a size; nothing else in it is true.
Bytes png_claiming(std::uint32_t width_px, std::uint32_t height_px);
// A JPEG whose header claims a size.
Bytes jpeg_claiming(const Bytes& jpeg, std::uint16_t width_px, std::uint16_t height_px);

}  // namespace mapweld::test
