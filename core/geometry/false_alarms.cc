#include "core/geometry/false_alarms.h"

#include <algorithm>
#include <limits>

#include "core/geometry/portable_math.h"

namespace mapweld {

Significance significance(std::span<const float> distances2, const ChanceModel& model, double max_distance) {
  Significance best{.inliers = 0, .log10_false_alarms = std::numeric_limits<double>::infinity()};
  const int n = static_cast<int>(distances2.size());
  if (n <= model.sample) return best;
  const double tests = portable_log10(model.solutions * (n - model.sample));
  const double log_share = portable_log10(model.share_in_radius);
  const double radius2 = model.radius * model.radius;
  constexpr double kFinest2 = 1e-6;  // 0.4 px at 320 x 240: below the accuracy of a feature a residual says no more
  for (int k = model.sample + 1; k <= n; ++k) {
    const double d2 = std::max<double>(distances2[k - 1], kFinest2);
    if (d2 > max_distance * max_distance) break;
    if (k < n && distances2[k] <= d2) continue;
    const double log_alpha = std::min(log_share + 0.5 * model.dimension * portable_log10(d2 / radius2), 0.0);
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

double share_within(std::span<const float> distances2, double radius) {
  const float radius2 = static_cast<float>(radius * radius);
  const auto within = std::ranges::count_if(distances2, [&](float d2) { return d2 <= radius2; });
  return static_cast<double>(within + 1) / static_cast<double>(distances2.size() + 1);
}

}  // namespace mapweld
