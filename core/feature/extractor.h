// SIFT features of a grey image (Lowe 2004; OpenCV's implementation).
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/types.h"

namespace mapweld {

struct ExtractorOptions {
  int max_features = 500;  // the strongest are kept; ties by position, so the choice is repeatable
};

// Extracts the strongest SIFT features of an 8-bit grey image. Keypoints come strongest first; an image without texture
// gives none. Deterministic and thread-safe: same pixels, same features, whatever runs beside it.
Features extract_features(const cv::Mat& grey, const ExtractorOptions& options = {});

}  // namespace mapweld
