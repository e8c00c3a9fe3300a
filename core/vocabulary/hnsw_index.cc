#include "core/vocabulary/hnsw_index.h"

#include <utility>

#include "core/errors.h"
#include "core/vocabulary/byte_stream.h"
#include "core/vocabulary/hnsw_search.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kFormat = 1;
constexpr int kMaxSearchEffort = 1 << 16;

int checked_effort(int effort) {
  if (effort < 1 || effort > kMaxSearchEffort) throw FormatError("HNSW: search effort out of range");
  return effort;
}

template <typename Word>
void search_all(HnswSearch<Word> search, std::span<const std::uint8_t> descriptors, std::span<WordId> words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = WordId{search.nearest(descriptors.data() + i * kDescriptorDimension)};
  }
}

}  // namespace

HnswIndex::HnswIndex(std::span<const std::uint8_t> centroids, HnswGraph graph, int search_effort)
    : centroids_(centroids), graph_(std::move(graph)), layout_(graph_), search_effort_(checked_effort(search_effort)) {}

void HnswIndex::quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const {
  const auto effort = static_cast<std::size_t>(search_effort_);
  if (layout_.is_narrow) {
    search_all(HnswSearch<std::uint16_t>(layout_, layout_.narrow, centroids_, effort), descriptors, words);
  } else {
    search_all(HnswSearch<std::uint32_t>(layout_, layout_.wide, centroids_, effort), descriptors, words);
  }
}

std::vector<std::uint8_t> HnswIndex::serialize() const {
  ByteWriter writer;
  writer.number(kFormat);
  writer.number(static_cast<std::uint32_t>(search_effort_));
  const std::vector<std::uint8_t> graph = encode_hnsw_graph(graph_);
  writer.array(std::span(graph));
  return writer.take();
}

std::unique_ptr<WordIndex> HnswIndex::build(std::span<const std::uint8_t> centroids, const WordIndexOptions& options) {
  const int effort = options.hnsw_search_effort == 0 ? kDefaultHnswSearchEffort : options.hnsw_search_effort;
  return std::make_unique<HnswIndex>(
      centroids, build_hnsw_graph(centroids, {options.hnsw_links, options.hnsw_build_effort, options.seed}), effort);
}

std::unique_ptr<WordIndex> HnswIndex::load(std::span<const std::uint8_t> centroids,
                                           std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  if (reader.number<std::uint32_t>() != kFormat) throw FormatError("HNSW index: unknown format");
  const auto effort = reader.number<std::uint32_t>();
  if (effort > kMaxSearchEffort) throw FormatError("HNSW index: search effort out of range");
  const auto graph = reader.array<std::uint8_t>();
  reader.expect_end();
  const auto words = static_cast<std::uint32_t>(centroids.size() / kDescriptorDimension);
  return std::make_unique<HnswIndex>(centroids, decode_hnsw_graph(graph, words), static_cast<int>(effort));
}

}  // namespace mapweld
