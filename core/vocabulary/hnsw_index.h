// The default engine: approximate search in an HNSW graph.
#pragma once

#include <memory>

#include "core/vocabulary/hnsw_graph.h"
#include "core/vocabulary/word_index.h"

namespace mapweld {

inline constexpr int kDefaultHnswSearchEffort = 32;  // measured: docs/vocabulary.md

class HnswIndex final : public WordIndex {
 public:
  // `centroids` must outlive the index. `search_effort`: ef, how many of the best words seen a search keeps open.
  // hnswlib's own search allocates two queues a query and waits for one neighbour after the other; this one keeps a
  // single sorted beam and asks memory for all neighbours of a node at once.
  HnswIndex(std::span<const std::uint8_t> centroids, HnswGraph graph, int search_effort);

  void quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const override;
  std::string_view engine() const override { return "hnsw"; }
  std::vector<std::uint8_t> serialize() const override;

  static std::unique_ptr<WordIndex> build(std::span<const std::uint8_t> centroids, const WordIndexOptions& options);
  static std::unique_ptr<WordIndex> load(std::span<const std::uint8_t> centroids, std::span<const std::uint8_t> bytes);

 private:
  class Search;
  std::span<const std::uint8_t> centroids_;
  HnswGraph graph_;
  int search_effort_;
};

}  // namespace mapweld
