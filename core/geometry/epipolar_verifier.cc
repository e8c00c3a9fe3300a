#include "core/geometry/epipolar_verifier.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/false_alarms.h"
#include "core/geometry/one_to_one.h"
#include "core/geometry/portable_math.h"
#include "core/geometry/similarity_support.h"
#include "core/geometry/spatial_consistency.h"
#include "core/geometry/two_view_geometry.h"
#include "core/geometry/word_matches.h"

namespace mapweld {
namespace {

constexpr int kMaxPairings = 9;   // of one word: 3 x 3
constexpr int kMaxMatches = 600;  // pairings of a pair of images
constexpr int kMinSupport = 2;    // others that agree with a match before it counts
constexpr int kBackgroundShifts = 32;
// Inliers spread at least so far around their centre, in one image or the other: root mean square, in shares of the
// diagonal. A fire cabinet or a notice hangs in two places; agreement about one small object is no place.
constexpr double kMinSpread = 0.08;
constexpr double kNominalTests = 100;  // pairs, models: see docs/verification.md, "Significance"
constexpr double kNoEvidence = 300;    // log10 of false alarms when there is no model at all

double spread(const std::vector<float>& x, const std::vector<float>& y, const std::vector<std::uint32_t>& chosen) {
  const double n = static_cast<double>(chosen.size());
  double mean_x = 0;
  double mean_y = 0;
  for (const std::uint32_t i : chosen) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  double mean_square = 0;
  for (const std::uint32_t i : chosen) {
    mean_square += ((x[i] - mean_x) * (x[i] - mean_x) + (y[i] - mean_y) * (y[i] - mean_y)) / n;
  }
  return std::sqrt(mean_square);
}

Verification verify_in_order(const AppearanceVector& a, const AppearanceVector& b, const VerifierOptions& options) {
  Verification v;
  v.log10_false_alarms = kNoEvidence;
  const auto reject = [&](Reason reason) {
    v.reason = reason;
    return v;
  };
  const std::size_t needed = static_cast<std::size_t>(std::max(options.min_inliers, kFewestInliers));
  if (a.appearances.size() < needed || b.appearances.size() < needed) return reject(Reason::kTooFewFeatures);

  const std::vector<WordMatch> pairings = word_matches(a, b, kMaxPairings, kMaxMatches);
  const Correspondences all = make_correspondences(a, b, pairings);
  const std::vector<std::uint16_t> support = similarity_support(all, {});
  const std::vector<std::uint32_t> matches = one_to_one(a, b, pairings, support);
  v.matches = static_cast<int>(matches.size());

  std::vector<std::uint32_t> supported;
  std::ranges::copy_if(matches, std::back_inserter(supported),
                       [&](std::uint32_t i) { return support[i] >= kMinSupport; });
  v.inliers = static_cast<int>(supported.size());
  if (supported.size() < needed) return reject(Reason::kTooFewInliers);

  const Correspondences c = select(all, supported);
  const TwoViewGeometry geometry = estimate_two_view_geometry(
      c, v.matches, shuffled(select(all, matches), kBackgroundShifts), 3 * content_hash(a) + content_hash(b), {});
  v.kind = geometry.kind;
  if (v.kind != GeometryKind::kNone) v.geometry = in_pixels(geometry, a, b);
  v.log10_false_alarms = std::min(geometry.log10_false_alarms + portable_log10(kNominalTests), kNoEvidence);
  v.inliers = static_cast<int>(geometry.inliers.size());
  if (geometry.inliers.size() < needed) return reject(Reason::kTooFewInliers);

  const std::vector<std::uint32_t> consistent = spatially_consistent(c, geometry.inliers, {});
  v.inliers = static_cast<int>(consistent.size());
  for (const std::uint32_t i : consistent) {
    v.inlier_matches.emplace_back(pairings[supported[i]].a, pairings[supported[i]].b);
  }
  std::ranges::sort(v.inlier_matches);
  if (consistent.size() < needed) return reject(Reason::kInconsistent);
  if (v.log10_false_alarms > portable_log10(options.max_false_alarms)) return reject(Reason::kNotSignificant);
  if (std::max(spread(c.xa, c.ya, consistent), spread(c.xb, c.yb, consistent)) < kMinSpread) {
    return reject(Reason::kNotSignificant);
  }
  v.accepted = true;
  return v;
}

}  // namespace

Verification EpipolarVerifier::verify(const AppearanceVector& a, const AppearanceVector& b) const {
  return a <= b ? verify_in_order(a, b, options_) : mirrored(verify_in_order(b, a, options_));
}

std::shared_ptr<const PairVerifier> make_verifier(const VerifierOptions& options) {
  return std::make_shared<EpipolarVerifier>(options);
}

}  // namespace mapweld
