#include "core/vocabulary/word_index.h"

#include "core/errors.h"
#include "core/vocabulary/exact_index.h"
#include "core/vocabulary/flann_index.h"
#include "core/vocabulary/hnsw_index.h"

namespace mapweld {
namespace {

void check_rows(std::span<const std::uint8_t> centroids) {
  if (centroids.size() % kDescriptorDimension != 0) throw FormatError("centroids are not rows of 128 bytes");
}

}  // namespace

std::unique_ptr<WordIndex> build_word_index(std::span<const std::uint8_t> centroids, const WordIndexOptions& options) {
  check_rows(centroids);
  if (options.engine == "hnsw") return HnswIndex::build(centroids, options);
  if (options.engine == "flann") return FlannIndex::build(centroids, options);
  if (options.engine == "exact") return std::make_unique<ExactIndex>(centroids);
  throw FormatError("unknown word index engine: " + options.engine);
}

std::unique_ptr<WordIndex> load_word_index(std::span<const std::uint8_t> centroids, std::string_view engine,
                                           std::span<const std::uint8_t> bytes) {
  check_rows(centroids);
  if (engine == "hnsw") return HnswIndex::load(centroids, bytes);
  if (engine == "flann") return FlannIndex::load(centroids, bytes);
  if (engine == "exact") {
    if (!bytes.empty()) throw FormatError("exact index: it has no bytes");
    return std::make_unique<ExactIndex>(centroids);
  }
  throw FormatError("unknown word index engine: " + std::string(engine));
}

}  // namespace mapweld
