#include "core/geometry/homography.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "core/wide_loops.h"

namespace mapweld {
namespace {

struct Normalisation {
  double x = 0, y = 0, scale = 1;
};

std::optional<Normalisation> normalise(const std::vector<float>& x, const std::vector<float>& y,
                                       std::span<const std::uint32_t> chosen) {
  Normalisation t;
  for (const std::uint32_t i : chosen) {
    t.x += x[i];
    t.y += y[i];
  }
  const double n = static_cast<double>(chosen.size());
  t.x /= n;
  t.y /= n;
  double variance = 0;
  for (const std::uint32_t i : chosen) variance += (x[i] - t.x) * (x[i] - t.x) + (y[i] - t.y) * (y[i] - t.y);
  if (!(variance > 1e-12 * n)) return std::nullopt;
  t.scale = std::sqrt(2 * n / variance);
  return t;
}

Matrix3 undo(const Eigen::Matrix3d& m, const Normalisation& a, const Normalisation& b) {
  Eigen::Matrix3d ta;
  ta << a.scale, 0, -a.scale * a.x, 0, a.scale, -a.scale * a.y, 0, 0, 1;
  Eigen::Matrix3d tb_inverse;
  tb_inverse << 1 / b.scale, 0, b.x, 0, 1 / b.scale, b.y, 0, 0, 1;
  const Eigen::Matrix3d h = tb_inverse * m * ta;
  Matrix3 out;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) out[3 * r + k] = h(r, k);
  }
  return out;
}

}  // namespace

std::optional<Matrix3> homography_from_many(const Correspondences& c, std::span<const std::uint32_t> chosen) {
  if (chosen.size() < 4) return std::nullopt;
  const auto a = normalise(c.xa, c.ya, chosen);
  const auto b = normalise(c.xb, c.yb, chosen);
  if (!a || !b) return std::nullopt;
  // Inhomogeneous, h33 = 1 in normalised coordinates: the centroid is a finite point of both views.
  Eigen::Matrix<double, 8, 8> m = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> y = Eigen::Matrix<double, 8, 1>::Zero();
  for (const std::uint32_t i : chosen) {
    const double xa = a->scale * (c.xa[i] - a->x), ya = a->scale * (c.ya[i] - a->y);
    const double xb = b->scale * (c.xb[i] - b->x), yb = b->scale * (c.yb[i] - b->y);
    const double rows[2][8] = {{xa, ya, 1, 0, 0, 0, -xb * xa, -xb * ya}, {0, 0, 0, xa, ya, 1, -yb * xa, -yb * ya}};
    const double rhs[2] = {xb, yb};
    for (int r = 0; r < 2; ++r) {
      for (int p = 0; p < 8; ++p) {
        y(p) += rows[r][p] * rhs[r];
        for (int q = 0; q <= p; ++q) m(p, q) += rows[r][p] * rows[r][q];
      }
    }
  }
  const Eigen::LDLT<Eigen::Matrix<double, 8, 8>, Eigen::Lower> ldlt(m);
  if (ldlt.info() != Eigen::Success || !(ldlt.rcond() > 1e-12)) return std::nullopt;
  const Eigen::Matrix<double, 8, 1> h = ldlt.solve(y);
  Eigen::Matrix3d out;
  out << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1;
  return undo(out, *a, *b);
}

std::optional<Matrix3> affine_from_many(const Correspondences& c, std::span<const std::uint32_t> chosen) {
  if (chosen.size() < 3) return std::nullopt;
  const auto a = normalise(c.xa, c.ya, chosen);
  const auto b = normalise(c.xb, c.yb, chosen);
  if (!a || !b) return std::nullopt;
  double xx = 0, xy = 0, yy = 0, xu = 0, yu = 0, xv = 0, yv = 0;
  for (const std::uint32_t i : chosen) {
    const double xa = a->scale * (c.xa[i] - a->x), ya = a->scale * (c.ya[i] - a->y);
    const double xb = b->scale * (c.xb[i] - b->x), yb = b->scale * (c.yb[i] - b->y);
    xx += xa * xa;
    xy += xa * ya;
    yy += ya * ya;
    xu += xa * xb;
    yu += ya * xb;
    xv += xa * yb;
    yv += ya * yb;
  }
  const double det = xx * yy - xy * xy;
  if (!(det > 1e-4 * xx * yy)) return std::nullopt;  // on a line
  Eigen::Matrix3d m;
  m << (yy * xu - xy * yu) / det, (xx * yu - xy * xu) / det, 0, (yy * xv - xy * yv) / det, (xx * yv - xy * xv) / det, 0,
      0, 0, 1;
  return undo(m, *a, *b);
}

void transfer_distances2(const Correspondences& c, const Matrix3& h, std::vector<float>& out) {
  const std::size_t n = c.size();
  out.resize(n);
  std::array<float, 9> m;
  for (int k = 0; k < 9; ++k) m[k] = static_cast<float>(h[k]);
  wide_loops([&]() MAPWELD_INLINE {
    for (std::size_t i = 0; i < n; ++i) {
      const float w = m[6] * c.xa[i] + m[7] * c.ya[i] + m[8];
      const float dx = (m[0] * c.xa[i] + m[1] * c.ya[i] + m[2]) / w - c.xb[i];
      const float dy = (m[3] * c.xa[i] + m[4] * c.ya[i] + m[5]) / w - c.yb[i];
      out[i] = w > 1e-6f ? dx * dx + dy * dy : std::numeric_limits<float>::infinity();
    }
  });
}

RobustHomography robust_homography(const Correspondences& c, float max_distance) {
  RobustHomography best;
  const std::uint32_t n = static_cast<std::uint32_t>(c.size());
  if (n < 4) return best;
  std::vector<float> d2;
  const auto within = [&](float distance) {
    std::vector<std::uint32_t> in;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (d2[i] <= distance * distance) in.push_back(i);
    }
    return in;
  };

  const float loose2 = 9 * max_distance * max_distance;
  int most = 0;
  std::uint32_t seed = 0;
  wide_loops([&]() MAPWELD_INLINE {
    for (std::uint32_t i = 0; i < n; ++i) {
      int agreeing = 0;
      for (std::size_t j = 0; j < n; ++j) {
        const float dxa = c.xa[j] - c.xa[i];
        const float dya = c.ya[j] - c.ya[i];
        const float ex = c.m_re[i] * dxa - c.m_im[i] * dya - (c.xb[j] - c.xb[i]);
        const float ey = c.m_im[i] * dxa + c.m_re[i] * dya - (c.yb[j] - c.yb[i]);
        agreeing += ex * ex + ey * ey <= loose2;
      }
      if (agreeing > most) {
        most = agreeing;
        seed = i;
      }
    }
  });
  if (most < 4) return best;
  const double tx = c.xb[seed] - (double{c.m_re[seed]} * c.xa[seed] - double{c.m_im[seed]} * c.ya[seed]);
  const double ty = c.yb[seed] - (double{c.m_im[seed]} * c.xa[seed] + double{c.m_re[seed]} * c.ya[seed]);
  transfer_distances2(c, {c.m_re[seed], -c.m_im[seed], tx, c.m_im[seed], c.m_re[seed], ty, 0, 0, 1}, d2);
  std::vector<std::uint32_t> in = within(3 * max_distance);
  for (const float factor : {2.5f, 2.0f, 1.5f}) {
    const auto affine = affine_from_many(c, in);
    if (!affine) break;
    transfer_distances2(c, *affine, d2);
    in = within(factor * max_distance);
  }
  for (int round = 0; round < 4; ++round) {
    const auto h = homography_from_many(c, in);
    if (!h) break;
    transfer_distances2(c, *h, d2);
    in = within(max_distance);
    if (in.size() <= best.inliers.size()) break;
    best = {.found = true, .h = *h, .inliers = in};
    in = within(1.5f * max_distance);
  }
  return best;
}

}  // namespace mapweld
