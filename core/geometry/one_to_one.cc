#include "core/geometry/one_to_one.h"

#include <algorithm>
#include <numeric>

namespace mapweld {
namespace {

bool same_location(const Appearance& p, const Appearance& q) {
  const float dx = p.x_px - q.x_px;
  const float dy = p.y_px - q.y_px;
  return dx * dx + dy * dy < 1.0f;
}

}  // namespace

std::vector<std::uint32_t> one_to_one(const AppearanceVector& a, const AppearanceVector& b,
                                      const std::vector<FeatureMatch>& matches,
                                      const std::vector<std::uint16_t>& support) {
  std::vector<std::uint32_t> order(matches.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, [&](std::uint32_t i, std::uint32_t j) {
    return support[i] != support[j] ? support[i] > support[j] : i < j;
  });
  std::vector<std::uint32_t> kept;
  kept.reserve(order.size());
  for (const std::uint32_t i : order) {
    const bool taken = std::ranges::any_of(kept, [&](std::uint32_t k) {
      return same_location(a.appearances[matches[i].a], a.appearances[matches[k].a]) ||
             same_location(b.appearances[matches[i].b], b.appearances[matches[k].b]);
    });
    if (!taken) kept.push_back(i);
  }
  std::ranges::sort(kept);
  return kept;
}

}  // namespace mapweld
