#include "core/geometry/spatial_consistency.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace mapweld {
namespace {

// Row i marks the `count` nearest of i; ties go to the lower index.
std::vector<std::uint8_t> nearest(const std::vector<float>& x, const std::vector<float>& y,
                                  const std::vector<std::uint32_t>& chosen, std::size_t count) {
  const std::size_t n = chosen.size();
  std::vector<std::uint8_t> near(n * n, 0);
  std::vector<std::uint64_t> order(n);  // distance, then index: floats that are not negative order as their bits do
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const float dx = x[chosen[j]] - x[chosen[i]];
      const float dy = y[chosen[j]] - y[chosen[i]];
      order[j] = std::uint64_t{std::bit_cast<std::uint32_t>(dx * dx + dy * dy)} << 32 | j;
    }
    order[i] = UINT64_MAX;  // not its own neighbour
    std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t r = 0; r < count; ++r) near[i * n + (order[r] & UINT32_MAX)] = 1;
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
