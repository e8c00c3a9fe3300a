// A number that two images share only if they are the same to the bit.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace mapweld::rendered {

// FNV-1a over the rows.
inline std::uint64_t checksum(const cv::Mat& image) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* row = image.ptr(y);
    for (std::size_t i = 0; i < static_cast<std::size_t>(image.cols) * image.elemSize(); ++i) {
      hash = (hash ^ row[i]) * 0x100000001b3ULL;
    }
  }
  return hash;
}

}  // namespace mapweld::rendered
