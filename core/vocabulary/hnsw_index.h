// The default engine: approximate search in an HNSW graph.
#pragma once

#include <memory>

#include "core/vocabulary/hnsw_graph.h"
#include "core/vocabulary/hnsw_layout.h"
#include "core/vocabulary/word_index.h"

namespace mapweld {

inline constexpr int kDefaultHnswSearchEffort = 24;  // measured: docs/vocabulary.md

// hnswlib builds the graph; the search is our own, and takes a fraction of its time on the same links. hnswlib
// allocates two queues a query and waits for one neighbour after the other; here the beam is one sorted array of
// numbers, the layout says without a lookup where to go on, and memory is asked for early (docs/vocabulary.md, "The
// search").
class HnswIndex final : public WordIndex {
 public:
  // `centroids` must outlive the index. `search_effort`: ef, how many of the best words seen a search keeps open.
  // Throws FormatError for an effort out of range or a graph that cannot be searched.
  HnswIndex(std::span<const std::uint8_t> centroids, HnswGraph graph, int search_effort);

  void quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const override;
  std::string_view engine() const override { return "hnsw"; }
  std::vector<std::uint8_t> serialize() const override;

  static std::unique_ptr<WordIndex> build(std::span<const std::uint8_t> centroids, const WordIndexOptions& options);
  static std::unique_ptr<WordIndex> load(std::span<const std::uint8_t> centroids, std::span<const std::uint8_t> bytes);

 private:
  std::span<const std::uint8_t> centroids_;
  HnswGraph graph_;
  HnswLayout layout_;
  int search_effort_;
};

}  // namespace mapweld
