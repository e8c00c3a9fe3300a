// One pair of images of a map, explained.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/contract/camera.h"
#include "client/contract/codec.h"

namespace mapweld::contract {

// What a merge, or mapping within one map, has made of a pair: an edge; a candidate that the verifier refused; a
// candidate that it was not asked about; a pair with too few votes to be asked about.
inline constexpr std::array<std::string_view, 4> kPairVerdicts = {"accepted", "rejected", "pending", "not_candidate"};

// A place in an image as the map has it (EXIF orientation applied): x to the right, y down, the centre of the upper
// left pixel is (0, 0).
struct ImagePoint {
  double x_px = 0;
  double y_px = 0;
  static constexpr auto fields() {
    return std::tuple(field("x_px", &ImagePoint::x_px), field("y_px", &ImagePoint::y_px));
  }
  friend bool operator==(const ImagePoint&, const ImagePoint&) = default;
};

// One thing that both images show.
struct PointMatch {
  ImagePoint u;
  ImagePoint v;
  static constexpr auto fields() { return std::tuple(field("u", &PointMatch::u), field("v", &PointMatch::v)); }
  friend bool operator==(const PointMatch&, const PointMatch&) = default;
};

// One thing that an edge's confidence is made of.
struct Evidence {
  std::string name;
  double value = 0;              // as it was measured
  std::optional<double> weight;  // what it adds to the log-odds of the confidence; null: a bar, or shown only
  std::string says;              // what it measures, in words
  static constexpr auto fields() {
    using E = Evidence;
    return std::tuple(field("name", &E::name), field("value", &E::value), field("weight", &E::weight),
                      field("says", &E::says));
  }
  friend bool operator==(const Evidence&, const Evidence&) = default;
};

// GET /v1/merges/{id}/pairs/{u}/{v}, and /v1/maps/{map}/pairs/{u}/{v}; u < v, numbers of the merge's map or of `map`.
struct Pair {
  std::int64_t u = 0;
  std::int64_t v = 0;
  std::string map;                    // the one that can have an edge of the two: where they first come together
  std::optional<std::int64_t> merge;  // that made `map`; null: two images of one plain map
  std::int64_t votes = 0;             // under the vote rule of the merge or map
  std::optional<int> matches;         // one-to-one; null where the verifier was not asked
  std::optional<int> inliers;         // likewise
  std::string verdict;                // one of kPairVerdicts
  std::optional<std::string> reason;  // why there is no edge; null for accepted (and confirmed) and pending
  std::optional<bool> confirmed;      // of an accepted pair: whether its edge is one of the map's; null for any other
  std::optional<double> confidence;   // of an accepted pair, 0 to 1; null: nobody has judged it
  std::optional<double> min_confidence;           // beside a confidence: what makes an edge of the map
  std::optional<std::vector<Evidence>> evidence;  // what the confidence is made of
  // From u to v; of an edge, and with ?matches=true. Absent: no cameras, or the images do not tell.
  std::optional<RelativePose> relative;
  // With ?matches=true only. Where there was no verdict, the verifier is asked for the answer; that changes no verdict.
  std::optional<std::string> kind;                        // of the geometry: "fundamental", "homography", "none"
  std::optional<double> log10_false_alarms;               // of the inliers, by chance; 300: no model at all
  std::optional<std::vector<PointMatch>> inlier_matches;  // those that held to the end
  static constexpr auto fields() {
    using P = Pair;
    return std::tuple(field("u", &P::u), field("v", &P::v), field("map", &P::map), field("merge", &P::merge),
                      field("votes", &P::votes), field("matches", &P::matches), field("inliers", &P::inliers),
                      field("verdict", &P::verdict), field("reason", &P::reason), field("confirmed", &P::confirmed),
                      field("confidence", &P::confidence), omitted_when_empty("min_confidence", &P::min_confidence),
                      omitted_when_empty("evidence", &P::evidence), omitted_when_empty("relative", &P::relative),
                      omitted_when_empty("kind", &P::kind),
                      omitted_when_empty("log10_false_alarms", &P::log10_false_alarms),
                      omitted_when_empty("inlier_matches", &P::inlier_matches));
  }
  friend bool operator==(const Pair&, const Pair&) = default;
};

}  // namespace mapweld::contract
