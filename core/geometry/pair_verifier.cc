#include "core/geometry/pair_verifier.h"

#include <algorithm>
#include <utility>

#include "core/geometry/matrix3.h"

namespace mapweld {
namespace {

// x_b^T F x_a = 0 becomes x_a^T F^T x_b = 0.
void transpose(std::array<double, 9>& m) {
  std::swap(m[1], m[3]);
  std::swap(m[2], m[6]);
  std::swap(m[5], m[7]);
}

}  // namespace

Verification mirrored(Verification v) {
  if (v.kind == GeometryKind::kHomography) {
    v.geometry = inverse(v.geometry);  // x_b ~ H x_a becomes x_a ~ H^-1 x_b
  } else {
    transpose(v.geometry);
  }
  for (auto& m : v.inlier_matches) std::swap(m.first, m.second);
  std::ranges::sort(v.inlier_matches);
  return v;
}

}  // namespace mapweld
