#include "core/geometry/false_alarms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/portable_math.h"

namespace mapweld {

Background::Background(std::span<const float> distances2, int dimension)
    : total_(static_cast<double>(distances2.size())), dimension_(dimension) {
  constexpr float kRadius2 = static_cast<float>(kRadius * kRadius);
  // Which are near nobody can foresee: no branch depends on it.
  near2_.resize(distances2.size() + 1);
  std::size_t near = 0;
  for (const float d2 : distances2) {
    near2_[near] = d2;
    near += d2 <= kRadius2 ? 1 : 0;
  }
  near2_.resize(near);
  std::ranges::sort(near2_);
}

double Background::share_within(double distance) const {
  const double d2 = distance * distance;
  const auto within = std::ranges::upper_bound(near2_, static_cast<float>(d2)) - near2_.begin();
  const double observed = static_cast<double>(within) / total_;
  double even = static_cast<double>(near2_.size() + 1) / (total_ + 1);
  const double ratio = std::min(distance / kRadius, 1.0);
  for (int i = 0; i < dimension_; ++i) even *= ratio;
  return std::max(observed, even);
}

Significance significance(std::span<const float> distances2, const ModelClass& model, const Background& background,
                          double max_distance) {
  Significance best{.inliers = 0, .log10_false_alarms = std::numeric_limits<double>::infinity()};
  const int n = static_cast<int>(distances2.size());
  if (n <= model.sample) return best;
  const double tests = portable_log10(model.solutions * (n - model.sample));
  constexpr double kFinest = 0.001;  // 0.4 px at 320 x 240: below the accuracy of a feature a residual says no more
  for (int k = model.sample + 1; k <= n; ++k) {
    const double distance = std::max(std::sqrt(static_cast<double>(distances2[k - 1])), kFinest);
    if (distance > max_distance) break;
    const double log_alpha = portable_log10(background.share_within(distance));
    const double nfa = tests + log10_binomial(n, k) + log10_binomial(k, model.sample) + (k - model.sample) * log_alpha;
    if (nfa < best.log10_false_alarms) best = {.inliers = k, .log10_false_alarms = nfa};
  }
  return best;
}

Correspondences shuffled(const Correspondences& c, int max_shifts) {
  const std::size_t n = c.size();
  Correspondences out;
  const std::size_t shifts = std::min<std::size_t>(n > 0 ? n - 1 : 0, static_cast<std::size_t>(max_shifts));
  for (auto* column : {&out.xa, &out.ya, &out.xb, &out.yb}) column->reserve(n * shifts);
  for (std::size_t s = 1; s <= shifts; ++s) {
    out.xa.insert(out.xa.end(), c.xa.begin(), c.xa.end());
    out.ya.insert(out.ya.end(), c.ya.begin(), c.ya.end());
    for (const auto& [from, to] : {std::pair{&c.xb, &out.xb}, std::pair{&c.yb, &out.yb}}) {
      to->insert(to->end(), from->begin() + static_cast<std::ptrdiff_t>(s), from->end());
      to->insert(to->end(), from->begin(), from->begin() + static_cast<std::ptrdiff_t>(s));
    }
  }
  return out;
}

}  // namespace mapweld
