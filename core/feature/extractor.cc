#include "core/feature/extractor.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include <opencv2/features2d.hpp>

namespace mapweld {
namespace {

// Lowe's values, which are OpenCV's defaults.
constexpr int kOctaveLayers = 3;
constexpr double kContrastThreshold = 0.04;
constexpr double kEdgeThreshold = 10;
constexpr double kSigma = 1.6;

bool stronger(const cv::KeyPoint& a, const cv::KeyPoint& b) {
  return std::tuple(-a.response, a.pt.y, a.pt.x, a.size, a.angle) <
         std::tuple(-b.response, b.pt.y, b.pt.x, b.size, b.angle);
}

}  // namespace

Features extract_features(const cv::Mat& grey, const ExtractorOptions& options) {
  if (grey.type() != CV_8UC1) throw std::invalid_argument("extract_features: the image is not 8-bit grey");
  if (options.max_features < 0) throw std::invalid_argument("extract_features: max_features is negative");
  Features features;
  features.width_px = grey.cols;
  features.height_px = grey.rows;
  if (grey.empty()) return features;

  // retainBest inside keeps all that tie with the weakest, so the cut below is over a set that no order decides.
  std::vector<cv::KeyPoint> found;
  cv::Mat descriptors;
  cv::SIFT::create(options.max_features, kOctaveLayers, kContrastThreshold, kEdgeThreshold, kSigma, CV_8U)
      ->detectAndCompute(grey, cv::noArray(), found, descriptors);

  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return stronger(found[a], found[b]); });
  if (options.max_features > 0)
    order.resize(std::min<std::size_t>(order.size(), static_cast<std::size_t>(options.max_features)));

  features.keypoints.reserve(order.size());
  features.descriptors.resize(order.size() * kDescriptorDimension);
  std::uint8_t* out = features.descriptors.data();
  for (const std::size_t i : order) {
    const cv::KeyPoint& keypoint = found[i];
    features.keypoints.push_back({keypoint.pt.x, keypoint.pt.y, keypoint.size, keypoint.angle});
    std::memcpy(out, descriptors.ptr(static_cast<int>(i)), kDescriptorDimension);
    out += kDescriptorDimension;
  }
  return features;
}

}  // namespace mapweld
