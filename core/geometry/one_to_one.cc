#include "core/geometry/one_to_one.h"

#include <algorithm>
#include <limits>

#include "core/wide_loops.h"

namespace mapweld {
namespace {

// The locations that are taken, of one image; in whole blocks, the rest of the last one infinitely far away.
class Taken {
 public:
  explicit Taken(std::size_t most) : x_(padded(most), kNowhere), y_(padded(most), kNowhere) {}

  // Whether one of the first `size` is less than 1 px away.
  MAPWELD_INLINE inline bool has(float x, float y, std::size_t size) const {
    int near = 0;
    for (std::size_t k = 0; k < padded(size); ++k) {
      const float dx = x - x_[k];
      const float dy = y - y_[k];
      near |= dx * dx + dy * dy < 1.0f ? 1 : 0;
    }
    return near != 0;
  }
  void set(std::size_t k, float x, float y) {
    x_[k] = x;
    y_[k] = y;
  }

 private:
  static constexpr std::size_t kBlock = 8;
  static constexpr float kNowhere = std::numeric_limits<float>::infinity();
  static constexpr std::size_t padded(std::size_t size) { return (size + kBlock - 1) / kBlock * kBlock; }

  std::vector<float> x_, y_;
};

// The best supported first; ties: the lower index.
std::vector<std::uint32_t> by_support(const std::vector<std::uint16_t>& support) {
  std::vector<std::uint64_t> keys(support.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = std::uint64_t{0xFFFFu - support[i]} << 32 | i;
  std::ranges::sort(keys);
  return {keys.begin(), keys.end()};  // the lower halves
}

}  // namespace

std::vector<std::uint32_t> one_to_one(const AppearanceVector& a, const AppearanceVector& b,
                                      const std::vector<FeatureMatch>& matches,
                                      const std::vector<std::uint16_t>& support) {
  std::vector<std::uint32_t> kept;
  kept.reserve(matches.size());
  Taken in_a(matches.size()), in_b(matches.size());
  wide_loops([&]() MAPWELD_INLINE {
    for (const std::uint32_t i : by_support(support)) {
      const Appearance& p = a.appearances[matches[i].a];
      const Appearance& q = b.appearances[matches[i].b];
      if (in_a.has(p.x_px, p.y_px, kept.size()) || in_b.has(q.x_px, q.y_px, kept.size())) continue;
      in_a.set(kept.size(), p.x_px, p.y_px);
      in_b.set(kept.size(), q.x_px, q.y_px);
      kept.push_back(i);
    }
  });
  std::ranges::sort(kept);
  return kept;
}

}  // namespace mapweld
