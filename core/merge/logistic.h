// The logistic function and its inverse, the same bits on every processor.
#pragma once

#include <algorithm>

#include "core/geometry/portable_math.h"

namespace mapweld {

// e^x as (1 + x / 1024)^1024, x clamped to [-12, 12]: near enough for chances, and only + and *.
inline double rough_exponential(double x) {
  double value = 1 + std::clamp(x, -12.0, 12.0) / 1024;
  for (int i = 0; i < 10; ++i) value *= value;
  return value;
}

inline double logistic(double x) { return 1 / (1 + rough_exponential(-x)); }

// ln(p / (1 - p)), p clamped to [1e-4, 1 - 1e-4].
inline double log_odds(double p) {
  p = std::clamp(p, 1e-4, 1 - 1e-4);
  return portable_log(p / (1 - p));
}

}  // namespace mapweld
