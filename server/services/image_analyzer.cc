#include "server/services/image_analyzer.h"

#include "core/feature/extractor.h"
#include "core/feature/mask.h"
#include "core/vocabulary/appearance_vector.h"

namespace mapweld::server {

AnalyzedImage analyze(std::span<const std::uint8_t> bytes, const Vocabulary& vocabulary, int max_features,
                      const cv::Mat& mask, ImageDecoder& decoder, Metrics& metrics) {
  Stopwatch watch;
  AnalyzedImage image;
  const DecodedImage decoded = decoder.decode(bytes, true);
  image.media_type = decoded.format == ImageHeader::Format::kPng ? "image/png" : "image/jpeg";
  image.width_px = decoded.grey.cols;
  image.height_px = decoded.grey.rows;
  const cv::Mat used = combined_masks(decoded.used, mask, decoded.grey.size());
  metrics.stage(Stage::kDecode).record(watch.lap_s());

  const Features features = extract_features(decoded.grey, {.max_features = max_features}, used);
  image.features = static_cast<int>(features.keypoints.size());
  metrics.stage(Stage::kSift).record(watch.lap_s());

  const std::vector<WordId> words = vocabulary.quantise(features);
  image.vector = std::make_shared<const AppearanceVector>(make_appearance_vector(features, words));
  metrics.stage(Stage::kQuantise).record(watch.lap_s());
  image.took_s = watch.elapsed_s();
  return image;
}

}  // namespace mapweld::server
