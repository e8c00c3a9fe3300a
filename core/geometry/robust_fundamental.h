// The fundamental matrix that most correspondences agree on: RANSAC with local optimisation (Fischler & Bolles 1981;
// Chum, Matas & Kittler 2003), as in the paper's section III-A.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/fundamental_matrix.h"

namespace mapweld {

struct RansacOptions {
  float max_distance = 0.005f;  // of an inlier from its epipolar lines, in shares of the diagonal: 2 px at 320 x 240
  int max_samples = 200;        // tried at most
  double confidence = 0.99;     // of having drawn one sample of inliers only
};

struct RobustFundamental {
  bool found = false;
  Matrix3 f{};
  std::vector<std::uint32_t> inliers;  // ascending
  int samples = 0;                     // drawn
};

// Draws from a sequence seeded with `seed`; repeatable. Fewer than eight correspondences: not found.
RobustFundamental robust_fundamental(const Correspondences& c, std::uint64_t seed, const RansacOptions& options);

}  // namespace mapweld
