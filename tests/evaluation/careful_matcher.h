// The careful matcher that the evaluation measures Mapweld by: what two photographs share when time does not matter.
//
// 2,000 SIFT features (OpenCV) at contrast threshold 0.02, compared exhaustively with Lowe's ratio test from both
// sides, mutual, and a fundamental matrix by MAGSAC++ (Barath et al., CVPR 2020; OpenCV's USAC_MAGSAC).
#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "tests/evaluation/nearest_descriptors.h"

namespace mapweld::evaluation {

struct CarefulMatcherOptions {
  int max_features = 2000;
  double contrast_threshold = 0.02;
  double max_ratio = 0.8;      // of the nearest's distance to the second nearest's
  double max_distance_px = 1;  // from the epipolar line
  int min_inliers = 15;        // a pair with so many is joined
};

struct CarefulImage {
  std::vector<cv::Point2f> points;
  DescriptorBlocks descriptors;
};

// Of an 8-bit grey image.
CarefulImage careful_image(const cv::Mat& grey, const CarefulMatcherOptions& options);

// Inliers of the fundamental matrix; 0 when there are fewer matches than `min_inliers`. Thread-safe; the same images
// give the same number.
int careful_inliers(const CarefulImage& a, const CarefulImage& b, const CarefulMatcherOptions& options);

}  // namespace mapweld::evaluation
