#include "core/geometry/spatial_consistency.h"

#include <algorithm>
#include <utility>

namespace mapweld {
namespace {

// near[i][j]: is j among the `count` nearest of i? Ties go to the lower index.
std::vector<std::vector<bool>> nearest(const std::vector<float>& x, const std::vector<float>& y,
                                       const std::vector<std::uint32_t>& chosen, std::size_t count) {
  const std::size_t n = chosen.size();
  std::vector<std::vector<bool>> near(n, std::vector<bool>(n, false));
  std::vector<std::pair<float, std::uint32_t>> order;
  for (std::size_t i = 0; i < n; ++i) {
    order.clear();
    for (std::size_t j = 0; j < n; ++j) {
      if (j == i) continue;
      const float dx = x[chosen[j]] - x[chosen[i]];
      const float dy = y[chosen[j]] - y[chosen[i]];
      order.emplace_back(dx * dx + dy * dy, static_cast<std::uint32_t>(j));
    }
    const std::size_t k = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k), order.end());
    for (std::size_t r = 0; r < k; ++r) near[i][order[r].second] = true;
  }
  return near;
}

}  // namespace

std::vector<std::uint32_t> spatially_consistent(const Correspondences& c, const std::vector<std::uint32_t>& chosen,
                                                const SpatialConsistencyOptions& options) {
  const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(options.neighbours), chosen.size() / 2);
  const auto near_a = nearest(c.xa, c.ya, chosen, count);
  const auto near_b = nearest(c.xb, c.yb, chosen, count);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    int support = 0;
    for (std::size_t j = 0; j < chosen.size(); ++j) support += near_a[i][j] && near_b[i][j];
    if (support >= options.min_support) kept.push_back(chosen[i]);
  }
  return kept;
}

}  // namespace mapweld
