#include "core/geometry/spatial_consistency.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/wide_loops.h"

namespace mapweld {
namespace {

// So many matches at a time. All that is done for one is done for all of them in one loop, which takes one instruction.
constexpr std::size_t kLanes = 8;
template <typename T>
using Lanes = std::array<T, kLanes>;

// Squared distances by their bits, which ascend as they do; of a match from itself the greatest.
using Distance = std::int32_t;
constexpr Distance kFar = std::numeric_limits<Distance>::max();

// The chosen matches in one of the two images.
struct Places {
  std::vector<float> x, y;

  Places(const std::vector<float>& all_x, const std::vector<float>& all_y, const std::vector<std::uint32_t>& chosen) {
    x.reserve(chosen.size());
    y.reserve(chosen.size());
    for (const std::uint32_t i : chosen) {
      x.push_back(all_x[i]);
      y.push_back(all_y[i]);
    }
  }
};

// The distances of the matches `first`, `first` + 1, ... from all of them; lanes beyond the last repeat it.
MAPWELD_INLINE inline void find_distances(const Places& places, std::size_t first,
                                          std::vector<Lanes<Distance>>& distances) {
  const std::size_t n = places.x.size();
  Lanes<float> x, y;
  Lanes<std::int32_t> own;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t i = std::min(first + lane, n - 1);
    x[lane] = places.x[i];
    y[lane] = places.y[i];
    own[lane] = static_cast<std::int32_t>(i);
  }
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float dx = places.x[j] - x[lane], dy = places.y[j] - y[lane];
      const auto d2 = std::bit_cast<Distance>(dx * dx + dy * dy);
      distances[j][lane] = own[lane] == static_cast<std::int32_t>(j) ? kFar : d2;
    }
  }
}

// As the compiler keeps them in registers.
using LanesInRegister = Distance __attribute__((vector_size(sizeof(Lanes<Distance>))));

// By lane, the `count`-th least distance; `count` at most kMost.
constexpr std::size_t kMost = 10;
MAPWELD_INLINE inline void find_nth_least(const std::vector<Lanes<Distance>>& distances, std::size_t count,
                                          Lanes<Distance>& found) {
  // Ascending; of places that are not asked for nothing is less.
  LanesInRegister least[kMost]{};
#pragma GCC unroll 10
  for (std::size_t k = 0; k < kMost; ++k) least[k] += k + count < kMost ? -1 : kFar;
  for (const Lanes<Distance>& next : distances) {
    LanesInRegister offered;
    std::memcpy(&offered, &next, sizeof(offered));
#pragma GCC unroll 10
    for (std::size_t k = 0; k < kMost; ++k) {
      const LanesInRegister greater = least[k] > offered ? least[k] : offered;
      least[k] = least[k] > offered ? offered : least[k];
      offered = greater;
    }
  }
  std::memcpy(&found, &least[kMost - 1], sizeof(found));
}

// Which are within the `count` nearest of a lane; ties go to the lower index.
std::vector<bool> nearest(const std::vector<Lanes<Distance>>& distances, std::size_t lane, Distance furthest,
                          std::size_t count) {
  std::vector<bool> near(distances.size(), false);
  for (std::size_t j = 0; j < near.size(); ++j) {
    near[j] = distances[j][lane] < furthest;
    count -= near[j] ? 1 : 0;
  }
  for (std::size_t j = 0; count > 0; ++j) {
    if (distances[j][lane] != furthest) continue;
    near[j] = true;
    --count;
  }
  return near;
}

// By match, how many are among its `count` nearest in both images.
MAPWELD_INLINE inline std::vector<int> count_common(const Places& a, const Places& b, std::size_t count) {
  const std::size_t n = a.x.size();
  std::vector<Lanes<Distance>> in_a(n), in_b(n);
  std::vector<int> common(n);
  for (std::size_t first = 0; first < n; first += kLanes) {
    find_distances(a, first, in_a);
    find_distances(b, first, in_b);
    Lanes<Distance> furthest_a, furthest_b;
    find_nth_least(in_a, count, furthest_a);
    find_nth_least(in_b, count, furthest_b);
    Lanes<int> near_a{}, near_b{}, near_both{};
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const int is_near_a = in_a[j][lane] <= furthest_a[lane] ? 1 : 0;
        const int is_near_b = in_b[j][lane] <= furthest_b[lane] ? 1 : 0;
        near_a[lane] += is_near_a;
        near_b[lane] += is_near_b;
        near_both[lane] += is_near_a & is_near_b;
      }
    }
    for (std::size_t lane = 0; lane < std::min(kLanes, n - first); ++lane) {
      common[first + lane] = near_both[lane];
      const auto expected = static_cast<int>(count);
      if (near_a[lane] == expected && near_b[lane] == expected) continue;
      const std::vector<bool> of_a = nearest(in_a, lane, furthest_a[lane], count);
      const std::vector<bool> of_b = nearest(in_b, lane, furthest_b[lane], count);
      common[first + lane] = 0;
      for (std::size_t j = 0; j < n; ++j) common[first + lane] += of_a[j] && of_b[j] ? 1 : 0;
    }
  }
  return common;
}

}  // namespace

std::vector<std::uint32_t> spatially_consistent(const Correspondences& c, const std::vector<std::uint32_t>& chosen,
                                                const SpatialConsistencyOptions& options) {
  const std::size_t n = chosen.size();
  const std::size_t count = std::min({static_cast<std::size_t>(options.neighbours), n / 2, kMost});
  if (count == 0) return options.min_support <= 0 ? chosen : std::vector<std::uint32_t>{};
  const Places a(c.xa, c.ya, chosen), b(c.xb, c.yb, chosen);
  const std::vector<int> common = wide_loops([&]() MAPWELD_INLINE { return count_common(a, b, count); });
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < n; ++i) {
    if (common[i] >= options.min_support) kept.push_back(chosen[i]);
  }
  return kept;
}

}  // namespace mapweld
