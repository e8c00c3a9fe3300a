// How well the matches of a pair agree about one local similarity: the cheap vote that goes before any estimation.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/correspondences.h"

namespace mapweld {

struct SimilaritySupportOptions {
  float max_turn_cos = 0.866f;  // angle differences of two agreeing matches differ by at most 30 degrees
  float max_ratio = 1.5f;       // their scale ratios by at most this factor
  float slack = 0.02f;          // the second lies where the first predicts it, up to so much of the diagonal
  float relative_slack = 0.3f;  // plus this share of their distance (perspective, parallax)
};

// For each match, how many others agree with it: same change of angle, same change of scale, and lying where the
// match's own similarity (SIFT's scale and angle) predicts them. Cost: n^2.
std::vector<std::uint16_t> similarity_support(const Correspondences& c, const SimilaritySupportOptions& options);

}  // namespace mapweld
