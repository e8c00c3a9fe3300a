#include "core/geometry/spatial_consistency.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/processor.h"

namespace mapweld {
namespace {

// The `count` nearest of each, row by row; ties go to the lower index. Inlined into a function of each instruction set;
// the same numbers everywhere, for no operation is fused or reordered.
__attribute__((always_inline)) inline std::vector<std::uint32_t> find_nearest(const std::vector<float>& x,
                                                                              const std::vector<float>& y,
                                                                              const std::vector<std::uint32_t>& chosen,
                                                                              std::size_t count) {
  const std::size_t n = chosen.size();
  std::vector<std::uint32_t> near;
  near.reserve(n * count);
  std::vector<float> px(n);
  std::vector<float> py(n);
  for (std::size_t i = 0; i < n; ++i) {
    px[i] = x[chosen[i]];
    py[i] = y[chosen[i]];
  }
  // Squared distances by their bits, which ascend as they do. Whole blocks that are too far are passed over.
  constexpr std::size_t kBlock = 16;
  constexpr std::uint32_t kFar = ~std::uint32_t{0};
  std::vector<std::uint32_t> d2((n + kBlock - 1) / kBlock * kBlock, kFar);
  // Distance and index as one number: those nearest are the least, ties go to the lower index.
  std::vector<std::uint64_t> best(count);  // ascending
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const float dx = px[j] - px[i], dy = py[j] - py[i];
      d2[j] = std::bit_cast<std::uint32_t>(dx * dx + dy * dy);
    }
    d2[i] = kFar;
    std::ranges::fill(best, ~std::uint64_t{0});
    std::uint32_t furthest = kFar;
    for (std::size_t first = 0; first < n; first += kBlock) {
      std::uint32_t least = kFar;
      for (std::size_t j = first; j < first + kBlock; ++j) least = std::min(least, d2[j]);
      if (least >= furthest) continue;
      for (std::size_t j = first; j < first + kBlock; ++j) {
        if (d2[j] >= furthest) continue;
        std::uint64_t key = std::uint64_t{d2[j]} << 32 | j;
        for (std::uint64_t& place : best) {
          const std::uint64_t greater = std::max(place, key);
          place = std::min(place, key);
          key = greater;
        }
        furthest = static_cast<std::uint32_t>(best.back() >> 32);
      }
    }
    for (const std::uint64_t key : best) near.push_back(static_cast<std::uint32_t>(key));
  }
  return near;
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) std::vector<std::uint32_t> find_nearest_avx2(const std::vector<float>& x,
                                                                             const std::vector<float>& y,
                                                                             const std::vector<std::uint32_t>& chosen,
                                                                             std::size_t count) {
  return find_nearest(x, y, chosen, count);
}
#endif

std::vector<std::uint32_t> nearest(const std::vector<float>& x, const std::vector<float>& y,
                                   const std::vector<std::uint32_t>& chosen, std::size_t count) {
#if defined(__x86_64__)
  static const bool avx2 = has_avx2();
  if (avx2) return find_nearest_avx2(x, y, chosen, count);
#endif
  return find_nearest(x, y, chosen, count);
}

}  // namespace

std::vector<std::uint32_t> spatially_consistent(const Correspondences& c, const std::vector<std::uint32_t>& chosen,
                                                const SpatialConsistencyOptions& options) {
  const std::size_t n = chosen.size();
  const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(options.neighbours), n / 2);
  if (count == 0) return options.min_support <= 0 ? chosen : std::vector<std::uint32_t>{};
  const std::vector<std::uint32_t> near_a = nearest(c.xa, c.ya, chosen, count);
  const std::vector<std::uint32_t> near_b = nearest(c.xb, c.yb, chosen, count);
  std::vector<std::uint32_t> kept;
  std::vector<std::size_t> seen_by(n, n);  // the last whose neighbour in the first image each was
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = i * count; k < (i + 1) * count; ++k) seen_by[near_a[k]] = i;
    int support = 0;
    for (std::size_t k = i * count; k < (i + 1) * count; ++k) support += seen_by[near_b[k]] == i ? 1 : 0;
    if (support >= options.min_support) kept.push_back(chosen[i]);
  }
  return kept;
}

}  // namespace mapweld
