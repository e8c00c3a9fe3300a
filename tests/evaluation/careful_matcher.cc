#include "tests/evaluation/careful_matcher.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

namespace mapweld::evaluation {

CarefulImage careful_image(const cv::Mat& grey, const CarefulMatcherOptions& options) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::SIFT::create(options.max_features, 3, options.contrast_threshold, 10, 1.6, CV_8U)
      ->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  std::vector<cv::Point2f> points;
  cv::KeyPoint::convert(keypoints, points);
  return {std::move(points), DescriptorBlocks({descriptors.data, descriptors.total()})};
}

int careful_inliers(const CarefulImage& a, const CarefulImage& b, const CarefulMatcherOptions& options) {
  const NearestDescriptors nearest = nearest_descriptors(a.descriptors, b.descriptors);
  const auto is_distinct = [&](const NearestDescriptor& n) {
    return n.distance2 < options.max_ratio * options.max_ratio * n.runner_up2;
  };
  std::vector<cv::Point2f> of_a, of_b;
  for (std::uint32_t i = 0; i < nearest.of_a.size(); ++i) {
    const NearestDescriptor& there = nearest.of_a[i];
    if (!is_distinct(there)) continue;
    const NearestDescriptor& back = nearest.of_b[there.index];
    if (back.index != i || !is_distinct(back)) continue;
    of_a.push_back(a.points[i]);
    of_b.push_back(b.points[there.index]);
  }
  if (of_a.size() < static_cast<std::size_t>(options.min_inliers)) return 0;
  cv::Mat is_inlier;
  const cv::Mat f =
      cv::findFundamentalMat(of_a, of_b, cv::USAC_MAGSAC, options.max_distance_px, 0.999, 2000, is_inlier);
  return f.empty() ? 0 : cv::countNonZero(is_inlier);
}

}  // namespace mapweld::evaluation
