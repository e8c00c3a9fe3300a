// Matches between two images: features that were given the same visual word.
#pragma once

#include <vector>

#include "core/geometry/feature_match.h"
#include "core/types.h"

namespace mapweld {

// All pairings of equal words, ascending by (a, b), of the words with at most `max_pairings` of them; a word that
// appears too often (a texture) says nothing about which of its features belong together. With more than
// `max_matches` pairings in all, the words with the most pairings are left out until the rest fits.
// Images have at most 65536 appearances, sorted by word.
std::vector<FeatureMatch> word_matches(const AppearanceVector& a, const AppearanceVector& b, int max_pairings,
                                       int max_matches);

}  // namespace mapweld
