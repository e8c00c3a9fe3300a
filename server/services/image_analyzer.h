// From the bytes of an uploaded image to its appearance vector: decode, SIFT, quantise.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

#include "core/types.h"
#include "core/vocabulary/vocabulary.h"
#include "server/decoding/image_decoder.h"
#include "server/metrics/metrics.h"

namespace mapweld::server {

struct AnalyzedImage {
  std::string media_type;  // "image/jpeg" or "image/png"
  int width_px = 0;        // as it is seen: EXIF orientation applied
  int height_px = 0;
  int features = 0;
  std::shared_ptr<const AppearanceVector> vector;
  double took_s = 0;
};

// `mask`: of the map (core/feature/mask.h), of any size; empty: it has none. Pure but for the stopwatch; any thread.
// Throws ImageError for bytes that are no usable image.
AnalyzedImage analyze(std::span<const std::uint8_t> bytes, const Vocabulary& vocabulary, int max_features,
                      const cv::Mat& mask, ImageDecoder& decoder, Metrics& metrics);

}  // namespace mapweld::server
