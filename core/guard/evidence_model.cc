#include "core/guard/evidence_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/geometry/portable_math.h"

namespace mapweld {
namespace {

constexpr double kFloor = 0.1;  // of a fullness in a logarithm: less says nothing more

constexpr int kSteps = 10000;

// Confidences step by 1/10000: the log odds at which each begins, by logarithms that are the same everywhere.
const std::array<double, kSteps>& steps() {
  static const std::array<double, kSteps> table = [] {
    std::array<double, kSteps> from{};
    from[0] = -std::numeric_limits<double>::infinity();
    for (int i = 1; i < kSteps; ++i) {
      const double p = (i - 0.5) / kSteps;
      from[static_cast<std::size_t>(i)] = portable_log(p) - portable_log(1 - p);
    }
    return from;
  }();
  return table;
}

}  // namespace

bool is_near_view(const EdgeSigns& signs, const EvidenceModel& model) {
  return signs.fullness >= model.near_view * signs.inner_fullness;
}

EvidenceParts weigh(const EdgeSigns& signs, const EvidenceModel& model, bool is_inner) {
  EvidenceParts parts;
  parts.prior = is_inner ? model.inner_prior : model.prior;
  const double far = signs.far_images;
  const double tested = far / (far + model.half_tested);
  const double unlike = model.usual_similarity * portable_log(1 + far) / (signs.common_share + model.common_floor);
  parts.rarity = model.rarity * portable_log(1 + signs.rare_matches * tested * unlike);
  parts.fullness = model.fullness * portable_log(std::max(1.0, signs.fullness_around / model.full));
  const double inner = signs.inner_fullness;
  const double density = inner * inner / (inner * inner + model.dense * model.dense);
  if (is_inner && is_near_view(signs, model)) parts.nearness = model.nearness * density * density * density * density;
  if (inner > signs.fullness_around) {
    parts.shortfall = model.shortfall * density * portable_log(std::max(kFloor, signs.fullness_around) / inner);
  }
  return parts;
}

double confidence_of(double log_odds) {
  const auto& from = steps();
  const auto next = std::ranges::upper_bound(from, log_odds);
  return static_cast<double>(next - from.begin() - 1) / kSteps;
}

double log_odds_of(double confidence) {
  const double step = std::ceil(confidence * kSteps - 1e-9);
  if (step >= kSteps) return std::numeric_limits<double>::infinity();
  return steps()[static_cast<std::size_t>(std::max(0.0, step))];
}

}  // namespace mapweld
