#include "core/vocabulary/exact_index.h"

#include <numeric>

#include "core/errors.h"
#include "core/vocabulary/distance.h"

namespace mapweld {

void ExactIndex::quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const {
  const std::size_t rows = centroids_.size() / kDescriptorDimension;
  if (rows == 0) throw FormatError("exact index: a vocabulary without words");
  const DistanceKernel& kernel = distance_kernel();
  std::vector<std::uint32_t> all(rows);
  std::iota(all.begin(), all.end(), 0u);
  std::vector<SquaredDistance> distances(rows);
  for (std::size_t i = 0; i < words.size(); ++i) {
    kernel.gather(descriptors.data() + i * kDescriptorDimension, centroids_.data(), all.data(), rows, distances.data());
    std::size_t best = 0;
    for (std::size_t row = 1; row < rows; ++row) {
      if (distances[row] < distances[best]) best = row;
    }
    words[i] = WordId{static_cast<std::uint32_t>(best)};
  }
}

}  // namespace mapweld
