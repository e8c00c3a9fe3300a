#include "core/feature/mask.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/feature/decode.h"

namespace mapweld {
namespace {

// A picture with holes.
struct Level {
  cv::Mat grey;   // CV_8UC1
  cv::Mat known;  // CV_8UC1, 0 in a hole
};

// Half the size: the mean of the known pixels among four.
Level halved(const Level& fine) {
  const cv::Size size((fine.grey.cols + 1) / 2, (fine.grey.rows + 1) / 2);
  Level coarse{cv::Mat(size, CV_8UC1, cv::Scalar(0)), cv::Mat(size, CV_8UC1, cv::Scalar(0))};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      int sum = 0;
      int count = 0;
      for (int v = 2 * y; v < std::min(2 * y + 2, fine.grey.rows); ++v) {
        for (int u = 2 * x; u < std::min(2 * x + 2, fine.grey.cols); ++u) {
          if (fine.known.at<std::uint8_t>(v, u) == 0) continue;
          sum += fine.grey.at<std::uint8_t>(v, u);
          ++count;
        }
      }
      if (count == 0) continue;
      coarse.grey.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>((sum + count / 2) / count);
      coarse.known.at<std::uint8_t>(y, x) = 255;
    }
  }
  return coarse;
}

// Fills the holes of `fine` from a picture of half its size without holes, between its pixels in proportion.
void fill_from(const cv::Mat& coarse, Level& fine) {
  const auto beside = [](int i, int count) { return std::clamp(i / 2 + (i % 2 == 0 ? -1 : 1), 0, count - 1); };
  for (int y = 0; y < fine.grey.rows; ++y) {
    const std::uint8_t* near = coarse.ptr(y / 2);
    const std::uint8_t* next = coarse.ptr(beside(y, coarse.rows));
    for (int x = 0; x < fine.grey.cols; ++x) {
      if (fine.known.at<std::uint8_t>(y, x) != 0) continue;
      const int u = x / 2;
      const int v = beside(x, coarse.cols);
      fine.grey.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>((9 * near[u] + 3 * near[v] + 3 * next[u] + next[v] + 8) / 16);
    }
  }
}

// Gortler et al., "The lumigraph" (SIGGRAPH 1996): pull and push.
void fill(Level& level) {
  if (cv::countNonZero(level.known) == static_cast<int>(level.known.total())) return;
  Level coarse = halved(level);
  fill(coarse);
  fill_from(coarse.grey, level);
}

}  // namespace

cv::Mat mask_of(const DecodedImage& image) {
  if (image.format != ImageHeader::Format::kPng) {
    throw ImageError("unsupported_image", "A mask is a PNG: white where an image is used, black where it is not.");
  }
  double brightest = 0;
  cv::minMaxLoc(image.grey, nullptr, &brightest, nullptr, nullptr, image.used);
  if (brightest == 0) throw ImageError("empty_mask", "The mask is black all over: no image would have a feature.");
  cv::Mat used = image.grey >= brightest / 2;
  if (!image.used.empty()) used &= image.used;
  return used;
}

cv::Mat combined_masks(const cv::Mat& used, const cv::Mat& mask, cv::Size size) {
  cv::Mat both;
  if (!mask.empty()) cv::resize(mask, both, size, 0, 0, cv::INTER_NEAREST);
  if (!used.empty()) both = both.empty() ? used : cv::Mat(both & used);
  return cv::countNonZero(both) == static_cast<int>(size.area()) ? cv::Mat() : both;
}

cv::Mat fill_unused(const cv::Mat& grey, const cv::Mat& used) {
  Level level{grey.clone(), used};
  fill(level);
  return level.grey;
}

}  // namespace mapweld
