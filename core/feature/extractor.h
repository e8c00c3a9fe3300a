// SIFT features of a grey image (Lowe 2004; OpenCV's implementation).
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/types.h"

namespace mapweld {

struct ExtractorOptions {
  int max_features = 500;  // the strongest are kept, ties by position, so the choice is repeatable; 0 keeps all
  // A larger image is shrunk to so many pixels before SIFT: the strongest few hundred features lose nothing, and SIFT
  // takes some 250 bytes a pixel. Keypoints are told in pixels of the image as given.
  int max_pixels = 1 << 20;
};

// Extracts the strongest SIFT features of an 8-bit grey image. Keypoints come strongest first; an image without
// texture, or too small for SIFT, gives none. Deterministic and thread-safe: same pixels, same features, whatever runs
// beside it.
//
// `used`: CV_8UC1 of the image's size, 0 where a pixel must bear no feature; empty: all may. What lies under unused
// pixels has no influence on anything, and neither they nor their border make a feature: one that has an unused pixel
// within its diameter (scale_px) is left out, and the strongest are chosen of the others.
//
// OpenCV's own threads are the process's business: a program that extracts many images at once calls
// cv::setNumThreads(1) in its main, and keep_freed_memory() (core/feature/allocation.h), which spares SIFT a third of
// its time. Throws std::invalid_argument for other than CV_8UC1, masks of another size, or negative options.
Features extract_features(const cv::Mat& grey, const ExtractorOptions& options = {}, const cv::Mat& used = {});

}  // namespace mapweld
