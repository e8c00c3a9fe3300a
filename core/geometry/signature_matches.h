// Matches between two images by the signatures of their features.
#pragma once

#include <vector>

#include "core/geometry/feature_match.h"
#include "core/types.h"

namespace mapweld {

// Bits of 128. Between two views of one point nine in ten signatures differ in at most 20 bits and 99 in a hundred in
// at most 30; of two others' one in a hundred differs in so few.
struct SignatureMatchOptions {
  int max_distance = 28;       // of two that are each other's nearest
  int max_word_distance = 40;  // of two features of one word
  // The nearest must be clearly nearer than the second nearest, seen from either image (Lowe 2004): at most so many
  // tenths of its distance.
  int max_tenths_of_runner_up = 9;
  float max_turn_deg = 45;  // only features whose angles differ from the images' turn by so much are compared
};

// Whether signatures are known.
bool has_signatures(const AppearanceVector& image);

// Features that are each other's nearest among those that `turn_deg` allows, and near and distinct enough; ascending by
// (a, b). `turn_deg`: by how much, about, the angles of b's features exceed those of a's. Both images have signatures.
std::vector<FeatureMatch> signature_matches(const AppearanceVector& a, const AppearanceVector& b, float turn_deg,
                                            const SignatureMatchOptions& options);

// Those of `matches` (of features of one word) whose signatures are near enough, in their order. Symmetric.
std::vector<FeatureMatch> with_near_signatures(const AppearanceVector& a, const AppearanceVector& b,
                                               const std::vector<FeatureMatch>& matches,
                                               const SignatureMatchOptions& options);

}  // namespace mapweld
