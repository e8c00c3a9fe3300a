// Matches between two images by the signatures of their features.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/feature_match.h"
#include "core/geometry/nearest_signatures.h"
#include "core/types.h"

namespace mapweld {

// Bits of 128. Between two views of one point nine in ten signatures differ in at most 20 bits and 99 in a hundred in
// at most 30; of two others' one in a hundred differs in so few.
struct SignatureMatchOptions {
  int max_distance = 28;  // of two that match
  // The nearest must be clearly nearer than the second nearest, seen from either image (Lowe 2004): at most so many
  // tenths of its distance.
  int max_tenths_of_runner_up = 9;
  float max_turn_deg =
      30;  // features whose angles differ from the images' turn by more, and by 1.4 more, are not compared
};

// Whether signatures are known.
bool has_signatures(const AppearanceVector& image);

// The signatures of an image as they are compared with those of others: its features in buckets by the upper byte of
// their angles (1.4 degrees), in the order of their numbers within one. At most 65535 features.
class SignaturesByAngle {
 public:
  explicit SignaturesByAngle(const AppearanceVector& image);

  // By feature: angles as they are stored, 65536 to a turn, so that sums wrap around by themselves.
  const std::vector<Signature>& signatures() const { return signatures_; }
  const std::vector<std::uint16_t>& angles() const { return angles_; }
  // By place in the order of angles.
  std::uint16_t feature(std::uint32_t place) const { return features_[place]; }
  const SignatureBlocks& blocks() const { return blocks_; }
  // The places of those from one angle to another, whole buckets.
  Compared between(std::uint16_t from, std::uint16_t to) const;

 private:
  std::vector<Signature> signatures_;
  std::vector<std::uint16_t> angles_, features_;
  std::array<std::uint32_t, 257> starts_{};
  SignatureBlocks blocks_;
};

// Features that are each other's nearest among those that `turn_deg` allows, and near and distinct enough; ascending by
// (a, b). `turn_deg`: by how much, about, the angles of b's features exceed those of a's. Both images have signatures.
std::vector<FeatureMatch> signature_matches(const SignaturesByAngle& a, const SignaturesByAngle& b, float turn_deg,
                                            const SignatureMatchOptions& options);
std::vector<FeatureMatch> signature_matches(const AppearanceVector& a, const AppearanceVector& b, float turn_deg,
                                            const SignatureMatchOptions& options);

// By how much most of the matches turn: in the middle of the window of 22.5 degrees that holds most of them, a multiple
// of 11.25 degrees; of several such windows the first. O(matches).
struct CommonTurn {
  float turn_deg = 0;
  std::size_t agreeing = 0;  // matches in the window
};
CommonTurn common_turn(const AppearanceVector& a, const AppearanceVector& b, const std::vector<FeatureMatch>& matches);

// Those of `matches` (of features of one word) whose signatures are near enough, in their order. Symmetric.
std::vector<FeatureMatch> with_near_signatures(const AppearanceVector& a, const AppearanceVector& b,
                                               const std::vector<FeatureMatch>& matches,
                                               const SignatureMatchOptions& options);

}  // namespace mapweld
