#include "core/vocabulary/flann_index.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <mutex>

#include <flann/flann.hpp>

#include "core/errors.h"
#include "core/vocabulary/byte_stream.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kFormat = 1;
constexpr int kBranching = 32;
constexpr int kIterations = 11;
constexpr int kDefaultChecks = 2048;

using Distance = flann::L2<std::uint8_t>;

flann::Matrix<std::uint8_t> as_matrix(std::span<const std::uint8_t> rows) {
  // FLANN's matrix is never const; it reads only.
  return {const_cast<std::uint8_t*>(rows.data()), rows.size() / kDescriptorDimension, kDescriptorDimension};
}

// k-means++ is the one way to choose centres that draws from a seedable generator.
flann::KMeansIndexParams tree_params() {
  return flann::KMeansIndexParams(kBranching, kIterations, flann::FLANN_CENTERS_KMEANSPP);
}

}  // namespace

struct FlannIndex::Tree {
  std::span<const std::uint8_t> centroids;
  flann::KMeansIndex<Distance> index;
  explicit Tree(std::span<const std::uint8_t> rows) : centroids(rows), index(as_matrix(rows), tree_params()) {}
};

FlannIndex::FlannIndex(std::unique_ptr<Tree> tree, int checks) : tree_(std::move(tree)), checks_(checks) {}
FlannIndex::~FlannIndex() = default;

std::unique_ptr<WordIndex> FlannIndex::build(std::span<const std::uint8_t> centroids, const WordIndexOptions& options) {
  if (centroids.empty()) throw FormatError("FLANN: a vocabulary without words");
  auto tree = std::make_unique<Tree>(centroids);
  static std::mutex generator;
  const std::lock_guard lock(generator);
  flann::seed_random(options.seed);
  tree->index.buildIndex();
  return std::unique_ptr<WordIndex>(new FlannIndex(std::move(tree), kDefaultChecks));
}

void FlannIndex::quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const {
  // Two neighbours, so that of equally near words the lower is taken.
  const std::size_t neighbours = std::min<std::size_t>(2, tree_->centroids.size() / kDescriptorDimension);
  std::vector<std::size_t> found(words.size() * neighbours);
  std::vector<float> distances(words.size() * neighbours);
  flann::Matrix<std::size_t> found_rows(found.data(), words.size(), neighbours);
  flann::Matrix<float> distance_rows(distances.data(), words.size(), neighbours);
  flann::SearchParams params(checks_);
  params.cores = 1;
  tree_->index.knnSearch(as_matrix(descriptors), found_rows, distance_rows, neighbours, params);
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::size_t best = found_rows[i][0];
    if (neighbours == 2 && distance_rows[i][1] == distance_rows[i][0]) best = std::min(best, found_rows[i][1]);
    words[i] = WordId{static_cast<std::uint32_t>(best)};
  }
}

std::vector<std::uint8_t> FlannIndex::serialize() const {
  char* archive = nullptr;
  std::size_t archive_bytes = 0;
  FILE* stream = open_memstream(&archive, &archive_bytes);
  if (stream == nullptr) throw std::bad_alloc();
  tree_->index.saveIndex(stream);
  std::fclose(stream);
  ByteWriter writer;
  writer.number(kFormat);
  writer.number(static_cast<std::uint32_t>(checks_));
  writer.array(std::span<const char>(archive, archive_bytes));
  std::free(archive);
  return writer.take();
}

std::unique_ptr<WordIndex> FlannIndex::load(std::span<const std::uint8_t> centroids,
                                            std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  if (reader.number<std::uint32_t>() != kFormat) throw FormatError("FLANN index: unknown format");
  const auto checks = reader.number<std::uint32_t>();
  auto archive = reader.array<std::uint8_t>();
  reader.expect_end();
  if (archive.empty() || centroids.empty()) throw FormatError("FLANN index: no archive");

  auto tree = std::make_unique<Tree>(centroids);
  FILE* stream = fmemopen(archive.data(), archive.size(), "rb");
  if (stream == nullptr) throw std::bad_alloc();
  try {
    tree->index.loadIndex(stream);
  } catch (const flann::FLANNException& broken) {
    std::fclose(stream);
    throw FormatError(std::string("FLANN index: ") + broken.what());
  }
  std::fclose(stream);
  return std::unique_ptr<WordIndex>(new FlannIndex(std::move(tree), static_cast<int>(checks)));
}

}  // namespace mapweld
