// Exact search by integer brute force: the oracle of the other engines, and what small vocabularies need.
#pragma once

#include "core/vocabulary/word_index.h"

namespace mapweld {

class ExactIndex final : public WordIndex {
 public:
  explicit ExactIndex(std::span<const std::uint8_t> centroids) : centroids_(centroids) {}

  void quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const override;
  std::string_view engine() const override { return "exact"; }
  std::vector<std::uint8_t> serialize() const override { return {}; }

 private:
  std::span<const std::uint8_t> centroids_;
};

}  // namespace mapweld
