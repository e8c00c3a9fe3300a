#include "core/geometry/robust_fundamental.h"

#include <algorithm>
#include <array>

#include "core/geometry/portable_math.h"
#include "core/random.h"

namespace mapweld {
namespace {

std::array<std::uint32_t, 7> draw_seven(SplitMix64& random, std::uint32_t n) {
  std::array<std::uint32_t, 7> sample{};
  for (int i = 0; i < 7; ++i) {
    std::uint32_t v = 0;
    do {
      v = random.below32(n);
    } while (std::find(sample.begin(), sample.begin() + i, v) != sample.begin() + i);
    sample[i] = v;
  }
  return sample;
}

// Truncated squared error, summed: smaller is better (MSAC; Torr & Zisserman 2000).
float truncated_error(const std::vector<float>& d2, float limit2) {
  float sum = 0;
  for (const float d : d2) sum += std::min(d, limit2);
  return sum;
}

// How many samples until one has seven inliers with the wanted confidence.
int samples_needed(double inlier_share, double confidence, int at_most) {
  double all = 1;
  for (int i = 0; i < 7; ++i) all *= inlier_share;
  if (all <= 1e-9) return at_most;
  if (all >= 1 - 1e-9) return 1;
  const double needed = portable_log(1 - confidence) / portable_log(1 - all);
  return needed >= at_most ? at_most : static_cast<int>(needed) + 1;
}

}  // namespace

RobustFundamental robust_fundamental(const Correspondences& c, std::uint64_t seed, const RansacOptions& options) {
  RobustFundamental best;
  const std::uint32_t n = static_cast<std::uint32_t>(c.size());
  if (n < 8) return best;
  const float limit2 = options.max_distance * options.max_distance;
  float best_error = limit2 * static_cast<float>(n);
  std::vector<float> d2;
  const auto inliers_of = [&](const std::vector<float>& distances2) {
    std::vector<std::uint32_t> in;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (distances2[i] <= limit2) in.push_back(i);
    }
    return in;
  };
  const auto consider = [&](const Matrix3& f) {
    epipolar_distances2(c, f, d2);
    const float error = truncated_error(d2, limit2);
    if (!(error < best_error)) return false;
    best_error = error;
    best.found = true;
    best.f = f;
    best.inliers = inliers_of(d2);
    return true;
  };

  SplitMix64 random(seed);
  std::array<Matrix3, 3> solutions;
  int needed = options.max_samples;
  for (best.samples = 0; best.samples < needed; ++best.samples) {
    const int solved = fundamental_from_seven(c, draw_seven(random, n), solutions);
    bool better = false;
    for (int s = 0; s < solved; ++s) better |= consider(solutions[s]);
    if (!better) continue;
    for (int round = 0; round < 4; ++round) {
      const auto refined = fundamental_from_many(c, best.inliers);
      if (!refined || !consider(*refined)) break;
    }
    needed = std::min(
        needed, samples_needed(static_cast<double>(best.inliers.size()) / n, options.confidence, options.max_samples));
  }
  return best;
}

}  // namespace mapweld
