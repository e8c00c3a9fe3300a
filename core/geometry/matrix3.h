// 3x3 matrices of two-view geometry.
#pragma once

#include <array>
#include <cmath>

namespace mapweld {

using Matrix3 = std::array<double, 9>;  // row-major

constexpr double determinant(const Matrix3& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

// The inverse up to scale, of Frobenius norm 1 (the adjugate); all zero when that vanishes.
inline Matrix3 inverse(const Matrix3& m) {
  Matrix3 out{m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
              m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
              m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
  double norm2 = 0;
  for (const double v : out) norm2 += v * v;
  const double norm = std::sqrt(norm2);
  if (norm > 0) {
    for (double& v : out) v /= norm;
  }
  return out;
}

}  // namespace mapweld
