#include "core/geometry/spatial_consistency.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace mapweld {
namespace {

// Row i marks the `count` nearest of i; ties go to the lower index.
std::vector<std::uint8_t> nearest(const std::vector<float>& x, const std::vector<float>& y,
                                  const std::vector<std::uint32_t>& chosen, std::size_t count) {
  const std::size_t n = chosen.size();
  std::vector<std::uint8_t> near(n * n, 0);
  if (count == 0) return near;
  std::vector<float> px(n);
  std::vector<float> py(n);
  for (std::size_t i = 0; i < n; ++i) {
    px[i] = x[chosen[i]];
    py[i] = y[chosen[i]];
  }
  std::vector<float> d2(n);
  std::vector<std::pair<float, std::uint32_t>> best(count);  // ascending
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) d2[j] = (px[j] - px[i]) * (px[j] - px[i]) + (py[j] - py[i]) * (py[j] - py[i]);
    std::ranges::fill(best, std::pair{std::numeric_limits<float>::infinity(), 0u});
    for (std::uint32_t j = 0; j < n; ++j) {
      if (!(d2[j] < best.back().first) || j == i) continue;
      std::size_t place = count - 1;
      for (; place > 0 && d2[j] < best[place - 1].first; --place) best[place] = best[place - 1];
      best[place] = {d2[j], j};
    }
    for (const auto& [distance2, j] : best) near[i * n + j] = 1;
  }
  return near;
}

}  // namespace

std::vector<std::uint32_t> spatially_consistent(const Correspondences& c, const std::vector<std::uint32_t>& chosen,
                                                const SpatialConsistencyOptions& options) {
  const std::size_t n = chosen.size();
  const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(options.neighbours), n / 2);
  const std::vector<std::uint8_t> near_a = nearest(c.xa, c.ya, chosen, count);
  const std::vector<std::uint8_t> near_b = nearest(c.xb, c.yb, chosen, count);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < n; ++i) {
    int support = 0;
    for (std::size_t k = i * n; k < (i + 1) * n; ++k) support += near_a[k] & near_b[k];
    if (support >= options.min_support) kept.push_back(chosen[i]);
  }
  return kept;
}

}  // namespace mapweld
