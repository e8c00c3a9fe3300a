// Number of false alarms of a set of inliers: how often chance alone would agree so well (Moisan & Stival 2004).
#pragma once

#include <span>

namespace mapweld {

// The best a-contrario reading of a geometry: the `inliers` smallest of the residuals are its inliers.
struct Significance {
  int inliers = 0;
  double log10_false_alarms = 0;  // of the best prefix, without the number of tests
};

// `distances2`: squared residuals of all n matches, ascending. A model takes `sample` matches to estimate and leaves
// `outcomes` solutions. A random match lies within distance d with probability `chance_per_distance` * d^dimension.
// Minimises over k > sample, with residuals up to max_distance:
//   log10 NFA(k) = log10[ outcomes (n - sample) C(n, k) C(k, sample) alpha_k^(k - sample) ].
// log10_false_alarms is +infinity when no k qualifies.
struct ChanceModel {
  int sample = 7;
  double outcomes = 3;
  double chance_per_distance = 1;
  int dimension = 1;
};
Significance significance(std::span<const float> distances2, const ChanceModel& model, double max_distance);

}  // namespace mapweld
