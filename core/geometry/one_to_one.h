// One match a feature, and one a location.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/feature_match.h"
#include "core/types.h"

namespace mapweld {

// Chooses among `matches` so that no two of them start or end at one location: a word that appears several times pairs
// ambiguously, and SIFT gives a point with several orientations several features. Locations are one when they are
// closer than 1 px. Matches with more `support` come first (ties: the lower index), so that those of a repeated word
// that agree with the rest win. Returns indices into `matches`, ascending.
std::vector<std::uint32_t> one_to_one(const AppearanceVector& a, const AppearanceVector& b,
                                      const std::vector<FeatureMatch>& matches,
                                      const std::vector<std::uint16_t>& support);

}  // namespace mapweld
