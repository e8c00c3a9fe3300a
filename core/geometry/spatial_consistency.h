// Spatial consistency of neighbouring matches (Sivic & Zisserman 2003, section 5.2; paper, section III-A).
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/correspondences.h"

namespace mapweld {

struct SpatialConsistencyOptions {
  int neighbours = 10;  // the search area of a match: so many nearest matches in either image; at most 10
  int min_support = 3;  // matches that are neighbours in both images
};

// The matches among `chosen` (ascending) that enough neighbours support: of the `neighbours` nearest matches in the
// first image, at least `min_support` are among the nearest in the second as well. With few matches the area is half
// of them. One pass, ascending.
std::vector<std::uint32_t> spatially_consistent(const Correspondences& c, const std::vector<std::uint32_t>& chosen,
                                                const SpatialConsistencyOptions& options);

}  // namespace mapweld
