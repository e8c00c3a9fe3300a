#include "core/feature/extractor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <vector>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/feature/mask.h"

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

// OpenCV's SIFT before 4.8 doubles the image with pixel areas aligned but halves coordinates as if pixel centres were,
// so everything lies a quarter of a pixel too far right and down.
constexpr float kDoublingShift_px = 0.25f;

cv::Mat shrink(const cv::Mat& grey, int max_pixels) {
  const double pixels = static_cast<double>(grey.total());
  if (pixels <= max_pixels) return grey;
  const double factor = std::sqrt(max_pixels / pixels);
  const auto side = [factor](int px) { return std::max(1, static_cast<int>(px * factor)); };
  cv::Mat small;
  cv::resize(grey, small, {side(grey.cols), side(grey.rows)}, 0, 0, cv::INTER_AREA);
  return small;
}

// Of a mask shrunk with its image: a pixel is used when all that went into it is.
cv::Mat shrink_mask(const cv::Mat& used, int max_pixels) { return shrink(used, max_pixels) == 255; }

// How far keypoints of OpenCV are from an unused pixel, against their diameter.
class MaskDistance {
 public:
  explicit MaskDistance(const cv::Mat& used) {
    cv::distanceTransform(used, distance_px_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  }
  bool is_clear(const cv::KeyPoint& keypoint) const {
    const int x = std::clamp(static_cast<int>(std::lround(keypoint.pt.x)), 0, distance_px_.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(keypoint.pt.y)), 0, distance_px_.rows - 1);
    return distance_px_.at<float>(y, x) > keypoint.size;
  }

 private:
  cv::Mat distance_px_;
};

}  // namespace

Features extract_features(const cv::Mat& grey, const ExtractorOptions& options, const cv::Mat& used) {
  if (grey.type() != CV_8UC1) throw std::invalid_argument("extract_features: the image is not 8-bit grey");
  if (!used.empty() && (used.type() != CV_8UC1 || used.size() != grey.size())) {
    throw std::invalid_argument("extract_features: the mask is not of the image's size, or not of bytes");
  }
  if (options.max_features < 0) throw std::invalid_argument("extract_features: max_features is negative");
  if (options.max_pixels < 1) throw std::invalid_argument("extract_features: max_pixels is not positive");
  Features features;
  features.width_px = grey.cols;
  features.height_px = grey.rows;
  if (grey.empty()) return features;

  cv::Mat image = shrink(grey, options.max_pixels);
  std::optional<MaskDistance> mask;
  if (!used.empty()) {
    const cv::Mat used_of_image = shrink_mask(used, options.max_pixels);
    if (cv::countNonZero(used_of_image) == 0) return features;
    image = fill_unused(image, used_of_image);
    mask.emplace(used_of_image);
  }
  // retainBest inside keeps all that tie with the weakest, so the cut below is over a set that no order decides.
  std::vector<cv::KeyPoint> found;
  cv::Mat descriptors;
  const int wanted = mask ? 0 : options.max_features;  // the strongest of those that the mask leaves
  cv::SIFT::create(wanted, kOctaveLayers, kContrastThreshold, kEdgeThreshold, kSigma, CV_8U)
      ->detectAndCompute(image, cv::noArray(), found, descriptors);

  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (mask) std::erase_if(order, [&](std::size_t i) { return !mask->is_clear(found[i]); });
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return stronger(found[a], found[b]); });
  if (options.max_features > 0) order.resize(std::min(order.size(), static_cast<std::size_t>(options.max_features)));

  const float x_scale = static_cast<float>(grey.cols) / static_cast<float>(image.cols);
  const float y_scale = static_cast<float>(grey.rows) / static_cast<float>(image.rows);
  const auto unshrink = [](float position, float scale) {
    return (position - kDoublingShift_px + 0.5f) * scale - 0.5f;
  };
  features.keypoints.reserve(order.size());
  features.descriptors.resize(order.size() * kDescriptorDimension);
  std::uint8_t* out = features.descriptors.data();
  for (const std::size_t i : order) {
    const cv::KeyPoint& keypoint = found[i];
    features.keypoints.push_back({unshrink(keypoint.pt.x, x_scale), unshrink(keypoint.pt.y, y_scale),
                                  keypoint.size * std::sqrt(x_scale * y_scale), keypoint.angle});
    std::memcpy(out, descriptors.ptr(static_cast<int>(i)), kDescriptorDimension);
    out += kDescriptorDimension;
  }
  return features;
}

}  // namespace mapweld
