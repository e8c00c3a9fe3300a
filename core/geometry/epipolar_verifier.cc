#include "core/geometry/epipolar_verifier.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/false_alarms.h"
#include "core/geometry/matchable_image.h"
#include "core/geometry/one_to_one.h"
#include "core/geometry/portable_math.h"
#include "core/geometry/signature_matches.h"
#include "core/geometry/similarity_support.h"
#include "core/geometry/spatial_consistency.h"
#include "core/geometry/static_matches.h"
#include "core/geometry/two_view_geometry.h"
#include "core/geometry/view_overlap.h"
#include "core/geometry/word_matches.h"

namespace mapweld {
namespace {

constexpr int kMaxPairings = 9;   // of one word: 3 x 3
constexpr int kMaxMatches = 600;  // pairings of a pair of images
constexpr int kMinSupport = 2;    // others that agree with a match before it counts
// Word matches with near signatures that agree about the images' turn, for all features to be compared.
constexpr std::size_t kWorthALook = 2;
constexpr int kBackgroundShifts = 32;
// Inliers spread at least so far around their centre, in one image or the other: root mean square, in shares of the
// diagonal. Agreement about one label or one lock is no place; a picture seen from afar is.
constexpr double kMinSpread = 0.05;
// Where signatures are known: of the features that both images should have, as far as the matches tell, so many match.
// A thing that stands in two places matches by itself, and nothing around it does. Most such pairs are refused before a
// geometry is estimated: of the supported matches seldom more are left after it.
constexpr double kMinMatchedShare = 0.06;
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

// The pairings of a pair of images, who of them agrees with whom, and which are left.
struct Vote {
  std::vector<FeatureMatch> pairings;
  Correspondences all;
  std::vector<std::uint32_t> matches;    // one to one: indices into the pairings
  std::vector<std::uint32_t> supported;  // those with kMinSupport
};

Vote count_votes(const AppearanceVector& a, const AppearanceVector& b, std::vector<FeatureMatch> pairings) {
  Vote vote;
  vote.pairings = std::move(pairings);
  vote.all = make_correspondences(a, b, vote.pairings);
  const std::vector<std::uint16_t> support = similarity_support(vote.all, {});
  vote.matches = one_to_one(a, b, vote.pairings, support);
  std::ranges::copy_if(vote.matches, std::back_inserter(vote.supported),
                       [&](std::uint32_t i) { return support[i] >= kMinSupport; });
  return vote;
}

std::vector<std::pair<std::uint16_t, std::uint16_t>> pairs_of(const std::vector<FeatureMatch>& matches,
                                                              const std::vector<std::uint32_t>& chosen) {
  std::vector<std::pair<std::uint16_t, std::uint16_t>> pairs;
  pairs.reserve(chosen.size());
  for (const std::uint32_t i : chosen) pairs.emplace_back(matches[i].a, matches[i].b);
  return pairs;
}

// With signatures, words only say which pairs are worth a closer look, and how one image is turned against the other.
std::vector<FeatureMatch> matches_by_signatures(const MatchableImage& a, const MatchableImage& b,
                                                std::vector<FeatureMatch> of_words) {
  const SignatureMatchOptions options;
  of_words = with_near_signatures(a.image(), b.image(), of_words, options);
  const CommonTurn turn = common_turn(a.image(), b.image(), of_words);
  if (turn.agreeing < kWorthALook) return of_words;
  const std::vector<FeatureMatch> nearest = signature_matches(a.signatures(), b.signatures(), turn.turn_deg, options);
  std::vector<FeatureMatch> all;
  all.reserve(of_words.size() + nearest.size());
  std::ranges::set_union(of_words, nearest, std::back_inserter(all));
  return all;
}

// `common`: the words that both have.
Verification verify_in_order(const MatchableImage& image_a, const MatchableImage& image_b,
                             std::span<const CommonWord> common, const VerifierOptions& options) {
  const AppearanceVector& a = image_a.image();
  const AppearanceVector& b = image_b.image();
  Verification v;
  v.log10_false_alarms = kNoEvidence;
  const auto reject = [&](Reason reason) {
    v.reason = reason;
    return v;
  };
  const std::size_t needed = static_cast<std::size_t>(std::max(options.min_inliers, kFewestInliers));
  if (a.appearances.size() < needed || b.appearances.size() < needed) return reject(Reason::kTooFewFeatures);

  const bool by_signatures = options.signatures && has_signatures(a) && has_signatures(b);
  std::vector<FeatureMatch> found = word_matches(common, kMaxPairings, kMaxMatches);
  if (by_signatures) found = matches_by_signatures(image_a, image_b, std::move(found));
  if (found.size() < needed) {
    v.matches = static_cast<int>(found.size());
    return reject(Reason::kTooFewInliers);
  }
  const Vote vote = count_votes(a, b, std::move(found));
  const std::vector<FeatureMatch>& pairings = vote.pairings;
  const std::vector<std::uint32_t>& supported = vote.supported;
  v.matches = static_cast<int>(vote.matches.size());
  v.inliers = static_cast<int>(supported.size());
  if (supported.size() < needed) return reject(Reason::kTooFewInliers);
  const auto is_too_little = [&](const std::vector<std::pair<std::uint16_t, std::uint16_t>>& matched) {
    return by_signatures && matched_share(image_a.places(), image_b.places(), matched) < kMinMatchedShare;
  };
  if (is_too_little(pairs_of(pairings, supported))) return reject(Reason::kInconsistent);

  const Correspondences c = select(vote.all, supported);
  const TwoViewGeometry geometry =
      estimate_two_view_geometry(c, v.matches, shuffled(select(vote.all, vote.matches), kBackgroundShifts),
                                 3 * image_a.content() + image_b.content(), {});
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
  if (is_too_little(v.inlier_matches)) return reject(Reason::kInconsistent);
  v.accepted = true;
  return v;
}

// By what is left of the images without what the camera carries with it.
Verification verify_rest_in_order(const MatchableImage& a, const MatchableImage& b, const VerifierOptions& options) {
  const std::vector<CommonWord> common = common_words(a.words(), b.words());
  const std::optional<WithoutStatic> rest = without_static(a.image(), b.image(), common, {});
  if (!rest) return verify_in_order(a, b, common, options);
  const MatchableImage rest_a(rest->a), rest_b(rest->b);
  Verification v = verify_in_order(rest_a, rest_b, common_words(rest_a.words(), rest_b.words()), options);
  for (auto& [in_a, in_b] : v.inlier_matches) {
    in_a = rest->index_a[in_a];
    in_b = rest->index_b[in_b];
  }
  return v;
}

Verification verify_matchable(const MatchableImage& a, const MatchableImage& b, const VerifierOptions& options) {
  return a.image() <= b.image() ? verify_rest_in_order(a, b, options) : mirrored(verify_rest_in_order(b, a, options));
}

}  // namespace

Verification EpipolarVerifier::verify(const AppearanceVector& a, const AppearanceVector& b) const {
  return verify_matchable(MatchableImage(a), MatchableImage(b), options_);
}

std::shared_ptr<const PreparedImage> EpipolarVerifier::prepare(std::shared_ptr<const AppearanceVector> image) const {
  return std::make_shared<MatchableImage>(std::move(image));
}

Verification EpipolarVerifier::verify_prepared(const PreparedImage& a, const PreparedImage& b) const {
  return verify_matchable(dynamic_cast<const MatchableImage&>(a), dynamic_cast<const MatchableImage&>(b), options_);
}

std::shared_ptr<const PairVerifier> make_verifier(const VerifierOptions& options) {
  return std::make_shared<EpipolarVerifier>(options);
}

}  // namespace mapweld
