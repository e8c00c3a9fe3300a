#include "core/geometry/fundamental_matrix.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/wide_loops.h"

namespace mapweld {
namespace {

// The real root of c3 x^3 + c2 x^2 + c1 x + c0 within [lo, hi], where its values have different signs: Newton's steps,
// halving where they lead astray.
double root_between(double c3, double c2, double c1, double c0, double lo, double hi) {
  const auto f = [&](double x) { return ((c3 * x + c2) * x + c1) * x + c0; };
  const bool rising = f(lo) < 0;
  double x = 0.5 * (lo + hi);
  for (int i = 0; i < 60; ++i) {
    const double value = f(x);
    (((value < 0) == rising) ? lo : hi) = x;
    const double slope = (3 * c3 * x + 2 * c2) * x + c1;
    double next = x - value / slope;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (std::fabs(next - x) <= 1e-14 * (1 + std::fabs(x))) return next;
    x = next;
  }
  return x;
}

// Real roots of c3 x^3 + c2 x^2 + c1 x + c0.
int cubic_roots(double c3, double c2, double c1, double c0, std::array<double, 3>& roots) {
  const auto f = [&](double x) { return ((c3 * x + c2) * x + c1) * x + c0; };
  if (std::fabs(c3) < 1e-14 * (std::fabs(c2) + std::fabs(c1) + std::fabs(c0))) return 0;
  const double bound = 1 + std::max({std::fabs(c2 / c3), std::fabs(c1 / c3), std::fabs(c0 / c3)});
  std::array<double, 4> ends{-bound, bound, bound, bound};
  int pieces = 1;
  const double q = c2 * c2 - 3 * c3 * c1;
  if (q > 0) {
    const double s = std::sqrt(q);
    double e0 = (-c2 - s) / (3 * c3);
    double e1 = (-c2 + s) / (3 * c3);
    if (e0 > e1) std::swap(e0, e1);
    ends = {-bound, e0, e1, bound};
    pieces = 3;
  }
  int n = 0;
  for (int i = 0; i < pieces; ++i) {
    if ((f(ends[i]) < 0) != (f(ends[i + 1]) < 0)) roots[n++] = root_between(c3, c2, c1, c0, ends[i], ends[i + 1]);
  }
  return n;
}

// The equations of seven matches, solved by Gauss-Jordan with full pivoting: seven pivot columns, two free ones span
// the null space.
class SevenEquations {
 public:
  SevenEquations(const Correspondences& c, const std::array<std::uint32_t, 7>& sample) {
    for (std::size_t r = 0; r < 7; ++r) {
      const std::uint32_t i = sample[r];
      const double xa = c.xa[i], ya = c.ya[i], xb = c.xb[i], yb = c.yb[i];
      rows_[r] = {xb * xa, xb * ya, xb, yb * xa, yb * ya, yb, xa, ya, 1};
    }
  }

  // False when they do not determine two dimensions.
  MAPWELD_INLINE inline bool eliminate() {
    for (std::size_t r = 0; r < 7; ++r) {
      // The greatest of each column, of which then that of all; of several equal ones the first by rows.
      Row greatest{};
      for (std::size_t i = r; i < 7; ++i) {
        for (std::size_t j = 0; j < kWidth; ++j) greatest[j] = std::max(greatest[j], std::fabs(rows_[i][j]));
      }
      const double best = *std::max_element(greatest.begin() + r, greatest.begin() + 9);
      if (!(best >= 1e-9)) return false;
      std::size_t row = r;
      std::size_t col = r;
      while (std::fabs(rows_[row][col]) != best) {
        if (++col == 9) {
          col = r;
          ++row;
        }
      }
      std::swap(rows_[r], rows_[row]);
      for (Row& each : rows_) std::swap(each[r], each[col]);
      std::swap(column_[r], column_[col]);
      // Columns before the r-th are done with: whatever is made of them is not looked at.
      const double inverse = 1 / rows_[r][r];
      for (std::size_t j = 0; j < kWidth; ++j) rows_[r][j] *= inverse;
      const Row pivot = rows_[r];
      for (std::size_t i = 0; i < 7; ++i) {
        if (i == r) continue;
        const double factor = rows_[i][r];
        for (std::size_t j = 0; j < kWidth; ++j) rows_[i][j] -= factor * pivot[j];
      }
    }
    return true;
  }

  void tell_null_space(Matrix3& f1, Matrix3& f2) const {
    for (std::size_t r = 0; r < 7; ++r) {
      f1[column_[r]] = -rows_[r][7];
      f2[column_[r]] = -rows_[r][8];
    }
    f1[column_[7]] = 1;
    f2[column_[8]] = 1;
  }

 private:
  static constexpr std::size_t kWidth = 12;  // nine columns, and zeros up to whole registers
  using Row = std::array<double, kWidth>;
  std::array<Row, 7> rows_;
  std::array<std::size_t, 9> column_{0, 1, 2, 3, 4, 5, 6, 7, 8};  // where each column came from
};

// The sums of products of all rows of an overdetermined system, row by row: its lower triangle.
class NormalEquations {
 public:
  MAPWELD_INLINE inline void add(const std::array<double, 9>& values) {
    std::array<double, kWidth> row{};
    std::copy(values.begin(), values.end(), row.begin());
    add_rows<0, 4>(row);
    add_rows<4, 8>(row);
    add_rows<8, 9>(row);
  }
  double at(std::size_t p, std::size_t q) const { return sums_[p][q]; }

 private:
  static constexpr std::size_t kWidth = 12;
  template <std::size_t kFrom, std::size_t kTo>
  MAPWELD_INLINE inline void add_rows(const std::array<double, kWidth>& row) {
    for (std::size_t p = kFrom; p < kTo; ++p) {
      for (std::size_t q = 0; q < (kTo + 3) / 4 * 4; ++q) sums_[p][q] += row[p] * row[q];
    }
  }
  std::array<std::array<double, kWidth>, 9> sums_{};
};

}  // namespace

int fundamental_from_seven(const Correspondences& c, const std::array<std::uint32_t, 7>& sample,
                           std::array<Matrix3, 3>& out) {
  SevenEquations equations(c, sample);
  if (!wide_loops([&]() MAPWELD_INLINE { return equations.eliminate(); })) return 0;
  Matrix3 f1{};
  Matrix3 f2{};
  equations.tell_null_space(f1, f2);

  // det(f1 + x (f2 - f1)) is a cubic in x; its coefficients from four values.
  Matrix3 d;
  for (int k = 0; k < 9; ++k) d[k] = f2[k] - f1[k];
  const auto at = [&](double x) {
    Matrix3 m;
    for (int k = 0; k < 9; ++k) m[k] = f1[k] + x * d[k];
    return m;
  };
  const double v0 = determinant(f1);
  const double c3 = determinant(d);
  const double v1 = determinant(at(1));
  const double vm = determinant(at(-1));
  const double c2 = 0.5 * (v1 + vm) - v0;
  const double c1 = 0.5 * (v1 - vm) - c3;
  std::array<double, 3> roots;
  const int n = cubic_roots(c3, c2, c1, v0, roots);
  for (int i = 0; i < n; ++i) out[i] = at(roots[i]);
  return n;
}

std::optional<Matrix3> fundamental_from_many(const Correspondences& c, std::span<const std::uint32_t> chosen) {
  if (chosen.size() < 8) return std::nullopt;
  // Normalise: mean 0, mean squared distance 2 (Hartley 1997).
  double mxa = 0, mya = 0, mxb = 0, myb = 0;
  for (const std::uint32_t i : chosen) {
    mxa += c.xa[i];
    mya += c.ya[i];
    mxb += c.xb[i];
    myb += c.yb[i];
  }
  const double n = static_cast<double>(chosen.size());
  mxa /= n;
  mya /= n;
  mxb /= n;
  myb /= n;
  double va = 0, vb = 0;
  for (const std::uint32_t i : chosen) {
    va += (c.xa[i] - mxa) * (c.xa[i] - mxa) + (c.ya[i] - mya) * (c.ya[i] - mya);
    vb += (c.xb[i] - mxb) * (c.xb[i] - mxb) + (c.yb[i] - myb) * (c.yb[i] - myb);
  }
  if (!(va > 0) || !(vb > 0)) return std::nullopt;
  const double sa = std::sqrt(2 * n / va);
  const double sb = std::sqrt(2 * n / vb);
  const NormalEquations equations = wide_loops([&]() MAPWELD_INLINE {
    NormalEquations sums;
    for (const std::uint32_t i : chosen) {
      const double xa = sa * (c.xa[i] - mxa), ya = sa * (c.ya[i] - mya);
      const double xb = sb * (c.xb[i] - mxb), yb = sb * (c.yb[i] - myb);
      sums.add({xb * xa, xb * ya, xb, yb * xa, yb * ya, yb, xa, ya, 1});
    }
    return sums;
  });
  Eigen::Matrix<double, 9, 9> ata = Eigen::Matrix<double, 9, 9>::Zero();
  for (int p = 0; p < 9; ++p) {
    for (int q = 0; q <= p; ++q) ata(p, q) = equations.at(static_cast<std::size_t>(p), static_cast<std::size_t>(q));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(ata);
  if (eigen.info() != Eigen::Success) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> v = eigen.eigenvectors().col(0);
  Eigen::Matrix3d f;
  f << v(0), v(1), v(2), v(3), v(4), v(5), v(6), v(7), v(8);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d s = svd.singularValues();
  s(2) = 0;
  f = svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
  Eigen::Matrix3d ta;
  ta << sa, 0, -sa * mxa, 0, sa, -sa * mya, 0, 0, 1;
  Eigen::Matrix3d tb;
  tb << sb, 0, -sb * mxb, 0, sb, -sb * myb, 0, 0, 1;
  f = tb.transpose() * f * ta;
  Matrix3 out;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) out[3 * r + k] = f(r, k);
  }
  return out;
}

void epipolar_distances2(const Correspondences& c, const Matrix3& f, std::vector<float>& out) {
  const std::size_t n = c.size();
  out.resize(n);
  double largest = 0;
  for (const double v : f) largest = std::max(largest, std::fabs(v));
  std::array<float, 9> m;
  for (int k = 0; k < 9; ++k) m[k] = static_cast<float>(f[k] / largest);
  wide_loops([&]() MAPWELD_INLINE {
    for (std::size_t i = 0; i < n; ++i) {
      const float xa = c.xa[i], ya = c.ya[i], xb = c.xb[i], yb = c.yb[i];
      const float lb0 = m[0] * xa + m[1] * ya + m[2];
      const float lb1 = m[3] * xa + m[4] * ya + m[5];
      const float lb2 = m[6] * xa + m[7] * ya + m[8];
      const float la0 = m[0] * xb + m[3] * yb + m[6];
      const float la1 = m[1] * xb + m[4] * yb + m[7];
      const float e = xb * lb0 + yb * lb1 + lb2;
      const float norm2 = std::min(lb0 * lb0 + lb1 * lb1, la0 * la0 + la1 * la1);
      out[i] = e * e / std::max(norm2, 1e-20f);
    }
  });
}

}  // namespace mapweld
