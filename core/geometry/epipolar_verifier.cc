#include "core/geometry/epipolar_verifier.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/false_alarms.h"
#include "core/geometry/portable_math.h"
#include "core/geometry/robust_fundamental.h"
#include "core/geometry/similarity_support.h"
#include "core/geometry/spatial_consistency.h"
#include "core/geometry/word_matches.h"

namespace mapweld {
namespace {

constexpr int kMaxPairings = 9;
constexpr int kMaxMatches = 600;
constexpr double kNominalTests = 1e2;

bool same_location(const Appearance& p, const Appearance& q) {
  const float dx = p.x_px - q.x_px;
  const float dy = p.y_px - q.y_px;
  return dx * dx + dy * dy < 1.0f;
}

// One match a feature and a location, those with the most support first.
std::vector<std::size_t> one_to_one(const AppearanceVector& a, const AppearanceVector& b,
                                    const std::vector<WordMatch>& matches, const std::vector<std::uint16_t>& support) {
  std::vector<std::size_t> order(matches.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t i, std::size_t j) { return support[i] > support[j]; });
  std::vector<std::size_t> kept;
  for (const std::size_t i : order) {
    const bool taken = std::ranges::any_of(kept, [&](std::size_t k) {
      return same_location(a.appearances[matches[i].a], a.appearances[matches[k].a]) ||
             same_location(b.appearances[matches[i].b], b.appearances[matches[k].b]);
    });
    if (!taken) kept.push_back(i);
  }
  std::ranges::sort(kept);
  return kept;
}

Verification verify_in_order(const AppearanceVector& a, const AppearanceVector& b, std::uint64_t seed,
                             const VerifierOptions& options) {
  Verification v;
  const auto reject = [&](Reason reason) {
    v.reason = reason;
    return v;
  };
  const std::size_t needed = static_cast<std::size_t>(std::max(options.min_inliers, 8));
  if (a.appearances.size() < needed || b.appearances.size() < needed) return reject(Reason::kTooFewFeatures);

  const std::vector<WordMatch> pairings = word_matches(a, b, kMaxPairings, kMaxMatches);
  const Correspondences all = make_correspondences(a, b, pairings);
  const std::vector<std::uint16_t> support = similarity_support(all, {});
  const std::vector<std::size_t> chosen = one_to_one(a, b, pairings, support);
  v.matches = static_cast<int>(chosen.size());

  std::vector<std::size_t> supported;
  for (const std::size_t i : chosen) {
    if (support[i] >= 2) supported.push_back(i);
  }
  v.inliers = static_cast<int>(supported.size());
  if (supported.size() < needed) return reject(Reason::kTooFewInliers);

  const Correspondences c = select(all, supported);
  const RobustFundamental model = robust_fundamental(c, seed, {});
  v.inliers = static_cast<int>(model.inliers.size());
  if (model.inliers.size() < needed) return reject(Reason::kTooFewInliers);

  v.kind = GeometryKind::kFundamental;
  v.geometry = model.f;
  std::vector<float> d2;
  epipolar_distances2(c, model.f, d2);
  d2.resize(chosen.size(), 1.0f);
  std::ranges::sort(d2);
  const Significance s =
      significance(d2, {.sample = 7, .outcomes = 3, .chance_per_distance = 4.2, .dimension = 1}, 0.005);
  v.log10_false_alarms = std::min(s.log10_false_alarms + portable_log10(kNominalTests), 300.0);

  const std::vector<std::uint32_t> consistent = spatially_consistent(c, model.inliers, {});
  v.inliers = static_cast<int>(consistent.size());
  for (const std::uint32_t i : consistent) {
    v.inlier_matches.emplace_back(pairings[supported[i]].a, pairings[supported[i]].b);
  }
  if (consistent.size() < needed) return reject(Reason::kInconsistent);
  if (v.log10_false_alarms > portable_log10(options.max_false_alarms)) return reject(Reason::kNotSignificant);
  v.accepted = true;
  return v;
}

}  // namespace

Verification EpipolarVerifier::verify(const AppearanceVector& a, const AppearanceVector& b) const {
  const std::uint64_t hash_a = content_hash(a);
  const std::uint64_t hash_b = content_hash(b);
  const bool in_order = hash_a != hash_b ? hash_a < hash_b : a <= b;
  if (!in_order) return mirrored(verify_in_order(b, a, hash_b * 3 + hash_a, options_));
  return verify_in_order(a, b, hash_a * 3 + hash_b, options_);
}

std::shared_ptr<const PairVerifier> make_verifier(const VerifierOptions& options) {
  return std::make_shared<EpipolarVerifier>(options);
}

}  // namespace mapweld
