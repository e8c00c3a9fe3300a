// Nearest visual word of a descriptor: the one interface behind which the engines stand (docs/design.md, "Words").
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace mapweld {

// Finds the nearest word (L2, integer distance) of each descriptor, exactly or approximately. Immutable once built:
// any number of threads may query. The same index gives the same words in every process and on every processor.
class WordIndex {
 public:
  virtual ~WordIndex() = default;

  // `descriptors`: N x 128 bytes, row-major. Writes N word ids. Ties go to the lower id.
  virtual void quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const = 0;

  // "hnsw", "flann" or "exact".
  virtual std::string_view engine() const = 0;

  // The built index without the centroids, in the engine's own versioned format; empty for "exact".
  virtual std::vector<std::uint8_t> serialize() const = 0;
};

struct WordIndexOptions {
  std::string engine = "hnsw";  // "hnsw" (Malkov & Yashunin 2018), "flann" (Muja & Lowe 2009), "exact"
  int hnsw_links = 16;          // M
  int hnsw_build_effort = 200;  // ef_construction
  int hnsw_search_effort = 0;   // ef; 0: the default, measured to reach at least 97 % recall (docs/vocabulary.md)
  std::uint32_t seed = 1;
};

// Builds an index over `centroids` (words x 128 bytes, row-major). Single-threaded and seeded: repeatable.
// The centroids must outlive the index. Throws FormatError for an unknown engine.
std::unique_ptr<WordIndex> build_word_index(std::span<const std::uint8_t> centroids, const WordIndexOptions& options);

// Restores what `serialize` gave, over the same centroids. Throws FormatError for foreign or torn bytes.
std::unique_ptr<WordIndex> load_word_index(std::span<const std::uint8_t> centroids, std::string_view engine,
                                           std::span<const std::uint8_t> bytes);

}  // namespace mapweld
