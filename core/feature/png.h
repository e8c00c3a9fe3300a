// PNG to grey pixels by libpng. Of an APNG, libpng sees the default image, which is its first frame.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <opencv2/core/mat.hpp>

namespace mapweld {

// A PNG that was read to its end.
struct PngImage {
  cv::Mat grey;  // CV_16UC1 of a file with 16 bits a sample, else CV_8UC1; colour by BT.601 as in JPEG
  cv::Mat used;  // CV_8UC1, 0 where alpha is 0 (by a channel of its own or a tRNS chunk), else 255; empty: everywhere
  int orientation = 1;  // EXIF, 1..8; not applied
};

// Any colour type and depth, interlaced or not. What it costs is bounded by the pixels and the bytes of the file:
// chunks but for pixels, transparency and EXIF are passed over, and a stream of pixels that goes on after the last row
// is refused. Throws ImageError undecodable_image: cut short, corrupt, a checksum that does not hold.
PngImage read_png_grey(std::span<const std::uint8_t> bytes);

}  // namespace mapweld
