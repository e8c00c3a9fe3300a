#include "core/geometry/pair_verifier.h"

#include <algorithm>
#include <utility>

namespace mapweld {
namespace {

// x_b^T F x_a = 0 becomes x_a^T F^T x_b = 0.
void transpose(std::array<double, 9>& m) {
  std::swap(m[1], m[3]);
  std::swap(m[2], m[6]);
  std::swap(m[5], m[7]);
}

// x_b ~ H x_a becomes x_a ~ H^-1 x_b; a homography is known up to scale, so the adjugate will do.
void invert(std::array<double, 9>& m) {
  m = {m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
       m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
       m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
}

}  // namespace

Verification mirrored(Verification v) {
  if (v.kind == GeometryKind::kHomography) {
    invert(v.geometry);
  } else {
    transpose(v.geometry);
  }
  for (auto& m : v.inlier_matches) std::swap(m.first, m.second);
  std::ranges::sort(v.inlier_matches);
  return v;
}

}  // namespace mapweld
