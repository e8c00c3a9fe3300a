// Number of false alarms of a geometry: how often chance alone would agree so well (Moisan & Stival 2004).
#pragma once

#include <span>
#include <vector>

#include "core/geometry/correspondences.h"

namespace mapweld {

// A model as chance meets it.
struct ModelClass {
  int sample = 7;        // matches that determine a solution
  double solutions = 3;  // solutions of one sample, at most
  int dimension = 1;     // 1: residuals are distances from a line, 2: from a point
};

// How often chance comes near a model: the residuals of a background under it (see `shuffled`).
class Background {
 public:
  // `distances2`: squared residuals of random matches; not empty.
  Background(std::span<const float> distances2, int dimension);
  // The probability that a random match has a residual of at most `distance`: as often as in the background, and at
  // least what is left of the share within kRadius when residuals spread evenly there.
  double share_within(double distance) const;

 private:
  static constexpr double kRadius = 0.03;
  std::vector<float> near2_;  // the squared residuals within kRadius, ascending
  double total_;
  int dimension_;
};

struct Significance {
  int inliers = 0;                // of the most meaningful threshold
  double log10_false_alarms = 0;  // its log10 NFA; +infinity when no threshold qualifies
};

// The a-contrario reading of a model: of n matches with squared residuals `distances2` (ascending), the k best are its
// inliers for the k > sample that minimises
//   log10 NFA(k) = log10[ solutions (n - sample) C(n, k) C(k, sample) alpha_k^(k - sample) ],
// alpha_k the background's share within the k-th residual, over residuals of at most max_distance (Moisan & Stival
// 2004, equation 12).
Significance significance(std::span<const float> distances2, const ModelClass& model, const Background& background,
                          double max_distance);

// The background of a pair of images: its own matches with their second ends exchanged, by cyclic shifts. Their
// residuals under a model say how often chance meets it where the features really are: in the far end of a corridor or
// on a grid of doors far more often than if features lay anywhere. At most `max_shifts` times as many as `c`.
Correspondences shuffled(const Correspondences& c, int max_shifts);

}  // namespace mapweld
