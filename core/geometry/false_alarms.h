// Number of false alarms of a geometry: how often chance alone would agree so well (Moisan & Stival 2004).
#pragma once

#include <span>

#include "core/geometry/correspondences.h"

namespace mapweld {

// What chance does to a geometric model.
struct ChanceModel {
  int sample = 7;                // matches that determine a solution
  double solutions = 3;          // solutions of one sample, at most
  int dimension = 1;             // 1: residuals are distances from a line, 2: from a point
  double radius = 0.03;          // a random match has a residual within `radius` ...
  double share_in_radius = 0.1;  // ... with this probability
};

struct Significance {
  int inliers = 0;                // of the most meaningful threshold
  double log10_false_alarms = 0;  // its log10 NFA; +infinity when no threshold qualifies
};

// The a-contrario reading of a model: of n matches with squared residuals `distances2` (ascending), the k best are its
// inliers for the k > sample that minimises
//   log10 NFA(k) = log10[ solutions (n - sample) C(n, k) C(k, sample) alpha_k^(k - sample) ],
//   alpha_k = share_in_radius (d_k / radius)^dimension,
// over residuals d_k <= max_distance (Moisan & Stival 2004, equation 12).
Significance significance(std::span<const float> distances2, const ChanceModel& model, double max_distance);

// The background of a pair of images: its own matches with their second ends exchanged, by cyclic shifts. Their
// residuals under a model say how often chance meets it where the features really are: in the far end of a corridor or
// on a grid of doors far more often than if features lay anywhere. At most `max_shifts` times as many as `c`.
Correspondences shuffled(const Correspondences& c, int max_shifts);

// The share of background residuals within `radius`; never 0 (one more is counted than there are).
double share_within(std::span<const float> distances2, double radius);

}  // namespace mapweld
