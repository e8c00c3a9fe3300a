// Localization (paper, section III-A): the vertices of a map most similar to a query image, with doubt admitted.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/geometry/pair_verifier.h"
#include "core/mapping/map_view.h"
#include "core/types.h"

namespace mapweld {

// The parameters of a map (http-api.md, "parameters"); defaults measured, see docs/verification.md.
struct MapParameters {
  int max_features = 500;
  std::uint32_t min_votes = default_min_votes(VoteRule::kSignatures);
  int min_inliers = 10;
  int max_inliers = 200;  // a new image with more inliers to some vertex is ignored as too similar; see mapper.h
  int verify_top = 50;    // so many best candidates are verified when localizing and mapping
  VoteRule votes = VoteRule::kSignatures;
  friend bool operator==(const MapParameters&, const MapParameters&) = default;
};

// As max_inliers: every image is kept, that of a camera at rest too.
inline constexpr int kUnlimitedInliers = 65535;

struct LocalizationMatch {
  VertexId vertex{};
  std::uint32_t votes = 0;
  bool verified = false;      // accepted by the verifier
  Verification verification;  // empty for candidates beyond verify_top
};

enum class LocalizationStatus : std::uint8_t { kLocalized, kAmbiguous, kNotFound };
std::string_view to_string(LocalizationStatus status);

struct Localization {
  LocalizationStatus status = LocalizationStatus::kNotFound;
  Reason reason = Reason::kNone;  // why not, when not localized
  struct Funnel {
    int features = 0;
    std::uint32_t known_words = 0;
    int candidates = 0;
    int verified = 0;  // candidates that were put to the verifier
    int best_inliers = 0;
    int needed_inliers = 0;
  } funnel;
  // Verified matches by inliers (ties: votes, vertex), then the others by votes (ties: vertex).
  std::vector<LocalizationMatch> matches;
};

// Two verified vertices show one place when they are at most so many hops apart in the map, or arrived at most so many
// images after one another: robots send images as they drive, and neighbours on a sparse drive may lack an edge.
inline constexpr int kSamePlaceHops = 3;
// A place is clearly ahead of another when its best match has more than so many times the other's inliers.
inline constexpr int kClearlyAhead = 2;

// Localizes `query`; changes nothing. Deterministic; thread-safe when the view is.
//
// Verified matches fall into places: two belong together when kSamePlaceHops says so, when their own images verify
// each other (an edge that the map lacks, as while a merge is running), or through others that do. Ambiguous: a match
// of another place than the best one's exists that the best one is not clearly ahead of (kClearlyAhead).
//
// The reason of a failure is that of the candidate that came furthest: inconsistent before not_significant before
// too_few_inliers. The verifier's own min_inliers decides; the one in `parameters` is for those who build it.
Localization localize(const AppearanceVector& query, const MapView& map, const PairVerifier& verifier,
                      const MapParameters& parameters);

}  // namespace mapweld
