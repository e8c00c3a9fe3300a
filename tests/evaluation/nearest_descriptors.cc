#include "tests/evaluation/nearest_descriptors.h"

#include <algorithm>
#include <array>
#include <cstddef>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "core/processor.h"
#include "core/types.h"

namespace mapweld::evaluation {
namespace {

constexpr std::size_t kPairs = kDescriptorDimension / 2;
constexpr std::size_t kRows = 4;      // of a block
constexpr std::size_t kColumns = 16;  // of a panel
using Tile = std::array<std::array<std::int32_t, kColumns>, kRows>;

std::size_t rounded_up(std::size_t n, std::size_t to) { return (n + to - 1) / to * to; }

// Products of four rows with the sixteen columns of a panel.
void multiply(const std::int16_t* rows, const std::int16_t* panel, Tile& tile) {
  for (std::size_t r = 0; r < kRows; ++r) {
    tile[r].fill(0);
    const std::int16_t* row = rows + r * kDescriptorDimension;
    for (std::size_t p = 0; p < kPairs; ++p) {
      for (std::size_t c = 0; c < kColumns; ++c) {
        const std::int16_t* column = panel + (p * kColumns + c) * 2;
        tile[r][c] += row[2 * p] * column[0] + row[2 * p + 1] * column[1];
      }
    }
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void multiply_avx2(const std::int16_t* rows, const std::int16_t* panel, Tile& tile) {
  __m256i sums[kRows][2] = {};
  for (std::size_t p = 0; p < kPairs; ++p) {
    const auto* columns = reinterpret_cast<const __m256i*>(panel + p * kColumns * 2);
    const __m256i left = _mm256_loadu_si256(columns);
    const __m256i right = _mm256_loadu_si256(columns + 1);
    for (std::size_t r = 0; r < kRows; ++r) {
      const __m256i row = _mm256_castps_si256(
          _mm256_broadcast_ss(reinterpret_cast<const float*>(rows + r * kDescriptorDimension + 2 * p)));
      sums[r][0] = _mm256_add_epi32(sums[r][0], _mm256_madd_epi16(row, left));
      sums[r][1] = _mm256_add_epi32(sums[r][1], _mm256_madd_epi16(row, right));
    }
  }
  for (std::size_t r = 0; r < kRows; ++r) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(tile[r].data()), sums[r][0]);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(tile[r].data() + 8), sums[r][1]);
  }
}
#endif

// The nearest and second nearest seen so far, a column for each number.
struct Nearest {
  std::vector<std::int32_t> distance2, runner_up2, index;
  explicit Nearest(std::size_t n)
      : distance2(n, NearestDescriptor::kNoDistance2), runner_up2(n, NearestDescriptor::kNoDistance2), index(n, 0) {}
};

// Takes in one row of a tile: sixteen candidates for sixteen places.
__attribute__((always_inline)) inline void take(const std::int32_t* d2, const std::int32_t* of, std::int32_t* best,
                                                std::int32_t* second, std::int32_t* index) {
  for (std::size_t c = 0; c < kColumns; ++c) {
    second[c] = std::min(second[c], std::max(best[c], d2[c]));
    index[c] = d2[c] < best[c] ? of[c] : index[c];
    best[c] = std::min(best[c], d2[c]);
  }
}

// Sixteen lanes of one row's nearest, brought together; ties go to the lower index.
NearestDescriptor brought_together(const std::int32_t* best, const std::int32_t* second, const std::int32_t* index) {
  NearestDescriptor nearest;
  for (std::size_t c = 0; c < kColumns; ++c) {
    const bool nearer = best[c] < nearest.distance2 ||
                        (best[c] == nearest.distance2 && static_cast<std::uint32_t>(index[c]) < nearest.index);
    const std::int32_t other = nearer ? nearest.distance2 : best[c];
    nearest.runner_up2 = std::min({nearest.runner_up2, second[c], other});
    if (!nearer) continue;
    nearest.distance2 = best[c];
    nearest.index = static_cast<std::uint32_t>(index[c]);
  }
  return nearest;
}

}  // namespace

DescriptorBlocks::DescriptorBlocks(std::span<const std::uint8_t> descriptors)
    : norms2_(descriptors.size() / kDescriptorDimension, 0) {
  const std::size_t n = norms2_.size();
  rows_.resize(rounded_up(n, kRows) * kDescriptorDimension, 0);
  panels_.resize(rounded_up(n, kColumns) * kDescriptorDimension, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < kDescriptorDimension; ++k) {
      const std::int16_t value = descriptors[i * kDescriptorDimension + k];
      rows_[i * kDescriptorDimension + k] = value;
      panels_[i / kColumns * kColumns * kDescriptorDimension + (k / 2 * kColumns + i % kColumns) * 2 + k % 2] = value;
      norms2_[i] += value * value;
    }
  }
}

// Goes through all tiles with the product of one instruction set.
class DescriptorProducts {
 public:
  DescriptorProducts(const DescriptorBlocks& a, const DescriptorBlocks& b)
      : a_(a), b_(b), of_b_(rounded_up(b.size(), kColumns)) {
    for (std::size_t j = 0; j < of_b_.index.size(); ++j) {
      numbers_.push_back(static_cast<std::int32_t>(j));
      // A column that is none is further away than any.
      column_norms2_.push_back(j < b.size() ? b.norms2_[j] : NearestDescriptor::kNoDistance2);
    }
  }

  template <auto kMultiply>
  __attribute__((always_inline)) inline void run(NearestDescriptors& nearest) {
    nearest.of_a.resize(a_.size());
    Tile tile;
    for (std::size_t i = 0; i < a_.size(); i += kRows) {
      const std::size_t rows = std::min(kRows, a_.size() - i);
      std::array<std::array<std::int32_t, kColumns>, kRows> best, second, index{};
      for (std::size_t r = 0; r < kRows; ++r) {
        best[r].fill(NearestDescriptor::kNoDistance2);
        second[r].fill(NearestDescriptor::kNoDistance2);
      }
      for (std::size_t j = 0; j < b_.size(); j += kColumns) {
        kMultiply(a_.rows_.data() + i * kDescriptorDimension, b_.panels_.data() + j * kDescriptorDimension, tile);
        for (std::size_t r = 0; r < rows; ++r) {
          std::array<std::int32_t, kColumns> d2, row;
          row.fill(static_cast<std::int32_t>(i + r));
          for (std::size_t c = 0; c < kColumns; ++c) {
            d2[c] =
                std::min(a_.norms2_[i + r] + column_norms2_[j + c] - 2 * tile[r][c], NearestDescriptor::kNoDistance2);
          }
          take(d2.data(), numbers_.data() + j, best[r].data(), second[r].data(), index[r].data());
          take(d2.data(), row.data(), of_b_.distance2.data() + j, of_b_.runner_up2.data() + j, of_b_.index.data() + j);
        }
      }
      for (std::size_t r = 0; r < rows; ++r) {
        nearest.of_a[i + r] = brought_together(best[r].data(), second[r].data(), index[r].data());
      }
    }
    for (std::size_t j = 0; j < b_.size(); ++j) {
      nearest.of_b.push_back({static_cast<std::uint32_t>(of_b_.index[j]), of_b_.distance2[j], of_b_.runner_up2[j]});
    }
  }

  void run_portably(NearestDescriptors& nearest) { run<multiply>(nearest); }
#if defined(__x86_64__)
  __attribute__((target("avx2"))) void run_avx2(NearestDescriptors& nearest) { run<multiply_avx2>(nearest); }
#endif

 private:
  const DescriptorBlocks& a_;
  const DescriptorBlocks& b_;
  Nearest of_b_;
  std::vector<std::int32_t> numbers_, column_norms2_;
};

NearestDescriptors nearest_descriptors(const DescriptorBlocks& a, const DescriptorBlocks& b, bool portable) {
  NearestDescriptors nearest;
  DescriptorProducts products(a, b);
#if defined(__x86_64__)
  if (!portable && has_avx2()) {
    products.run_avx2(nearest);
    return nearest;
  }
#endif
  products.run_portably(nearest);
  return nearest;
}

}  // namespace mapweld::evaluation
