#include "core/geometry/false_alarms.h"

#include <algorithm>
#include <limits>

#include "core/geometry/portable_math.h"

namespace mapweld {

Significance significance(std::span<const float> distances2, const ChanceModel& model, double max_distance) {
  Significance best{.inliers = 0, .log10_false_alarms = std::numeric_limits<double>::infinity()};
  const int n = static_cast<int>(distances2.size());
  if (n <= model.sample) return best;
  const double tests = portable_log10(model.outcomes * (n - model.sample));
  constexpr double kFinest2 = 1e-8;  // residuals below the accuracy of a feature's position say no more
  for (int k = model.sample + 1; k <= n; ++k) {
    const double d2 = std::max<double>(distances2[k - 1], kFinest2);
    if (d2 > max_distance * max_distance) break;
    double log_alpha = portable_log10(model.chance_per_distance) + 0.5 * model.dimension * portable_log10(d2);
    log_alpha = std::min(log_alpha, 0.0);
    const double nfa = tests + log10_binomial(n, k) + log10_binomial(k, model.sample) + (k - model.sample) * log_alpha;
    if (nfa < best.log10_false_alarms) best = {.inliers = k, .log10_false_alarms = nfa};
  }
  return best;
}

}  // namespace mapweld
