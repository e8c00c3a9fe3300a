#include "server/services/image_analyzer.h"

#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/vocabulary/appearance_vector.h"

namespace mapweld::server {

AnalyzedImage analyze(std::span<const std::uint8_t> bytes, const Vocabulary& vocabulary, int max_features,
                      Metrics& metrics) {
  Stopwatch watch;
  AnalyzedImage image;
  image.media_type = read_image_header(bytes).format == ImageHeader::Format::kPng ? "image/png" : "image/jpeg";
  const cv::Mat grey = decode_grey(bytes);
  image.width_px = grey.cols;
  image.height_px = grey.rows;
  metrics.stage(Stage::kDecode).record(watch.lap_s());

  const Features features = extract_features(grey, {.max_features = max_features});
  image.features = static_cast<int>(features.keypoints.size());
  metrics.stage(Stage::kSift).record(watch.lap_s());

  const std::vector<WordId> words = vocabulary.quantise(features);
  image.vector = std::make_shared<const AppearanceVector>(make_appearance_vector(features, words));
  metrics.stage(Stage::kQuantise).record(watch.lap_s());
  image.took_s = watch.elapsed_s();
  return image;
}

}  // namespace mapweld::server
