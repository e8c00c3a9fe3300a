// Descriptors made for tests: like SIFT's, they come in clusters and vary in far fewer ways than 128. (Points spread
// evenly in 128 dimensions are all equally far from each other, and nearest neighbours mean nothing.)
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace mapweld::test {

// `count` descriptors around `clusters` centres, each component off by at most `spread`. The centres depend on
// `clusters` alone, so that sets of other seeds lie around the same ones.
inline std::vector<std::uint8_t> clustered_descriptors(std::size_t count, std::size_t clusters, int spread,
                                                       std::uint64_t seed) {
  SplitMix64 centre_random(clusters);
  std::vector<std::uint8_t> centres(clusters * kDescriptorDimension);
  const auto draw = [&centre_random](int reach) {
    return static_cast<int>(centre_random.below(static_cast<std::uint64_t>(2 * reach + 1))) - reach;
  };
  constexpr std::size_t kFactors = 10;
  std::vector<int> patterns(kFactors * kDescriptorDimension);
  for (int& component : patterns) component = draw(24);
  for (std::size_t centre = 0; centre < clusters; ++centre) {
    int weights[kFactors];
    for (int& weight : weights) weight = draw(16);
    for (std::size_t k = 0; k < kDescriptorDimension; ++k) {
      int sum = 0;
      for (std::size_t j = 0; j < kFactors; ++j) sum += weights[j] * patterns[j * kDescriptorDimension + k];
      centres[centre * kDescriptorDimension + k] = static_cast<std::uint8_t>(std::clamp(90 + sum / 8, 0, 255));
    }
  }
  SplitMix64 random(seed);
  std::vector<std::uint8_t> rows(count * kDescriptorDimension);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t centre = random.below(clusters);
    for (std::size_t k = 0; k < kDescriptorDimension; ++k) {
      const int offset = static_cast<int>(random.below(static_cast<std::uint64_t>(2 * spread + 1))) - spread;
      rows[i * kDescriptorDimension + k] =
          static_cast<std::uint8_t>(std::clamp(centres[centre * kDescriptorDimension + k] + offset, 0, 255));
    }
  }
  return rows;
}

// The oracle: squared distance, straight from its definition.
inline std::int64_t squared_distance(const std::uint8_t* a, const std::uint8_t* b) {
  std::int64_t sum = 0;
  for (int k = 0; k < kDescriptorDimension; ++k) sum += (std::int64_t{a[k]} - b[k]) * (std::int64_t{a[k]} - b[k]);
  return sum;
}

// The oracle: the nearest row, the first of equally near ones.
inline std::uint32_t nearest_row(const std::uint8_t* query, const std::vector<std::uint8_t>& rows) {
  std::uint32_t best = 0;
  std::int64_t best_distance = -1;
  for (std::size_t i = 0; i < rows.size() / kDescriptorDimension; ++i) {
    const std::int64_t distance = squared_distance(query, rows.data() + i * kDescriptorDimension);
    if (best_distance < 0 || distance < best_distance) {
      best = static_cast<std::uint32_t>(i);
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace mapweld::test
