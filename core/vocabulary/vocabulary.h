// A visual vocabulary: k-means centroids of SIFT descriptors (the paper's dictionary) and the index that quantises.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"
#include "core/vocabulary/word_index.h"

namespace mapweld {

// Immutable and thread-safe; share it by shared_ptr<const Vocabulary>.
class Vocabulary {
 public:
  // `centroids`: words x 128 bytes, row-major.
  Vocabulary(const std::vector<std::uint8_t>& centroids, const WordIndexOptions& options);

  std::uint32_t words() const;
  std::span<const std::uint8_t> centroids() const;
  const WordIndex& index() const;

  // Nearest word of each descriptor of `features`, in their order.
  std::vector<WordId> quantise(const Features& features) const;

  // The vocabulary file: words and built index, versioned, checksummed (format: docs/vocabulary.md).
  std::vector<std::uint8_t> serialize() const;
  // Throws FormatError for foreign, torn or newer bytes.
  static std::shared_ptr<const Vocabulary> deserialize(std::span<const std::uint8_t> bytes);

 private:
  struct Parts;
  explicit Vocabulary(std::shared_ptr<const Parts> parts);
  std::shared_ptr<const Parts> parts_;
};

}  // namespace mapweld
