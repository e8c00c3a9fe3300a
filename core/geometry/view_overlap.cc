#include "core/geometry/view_overlap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "core/vocabulary/appearance_vector.h"

namespace mapweld {
namespace {

// Positions are whole numbers on their grid, and sums of whole numbers do not depend on their order.
std::int64_t on_grid(float px) { return static_cast<std::int64_t>(px * kPositionsPerPixel); }

struct Moments {
  std::int64_t n = 0;
  std::int64_t x = 0, y = 0;    // of one image
  std::int64_t u = 0, v = 0;    // of the other
  std::int64_t xx = 0, uu = 0;  // squared distances from the origin
  std::int64_t along = 0;       // sum of x u + y v
  std::int64_t across = 0;      // sum of x v - y u

  Moments exchanged() const { return {n, u, v, x, y, uu, xx, along, -across}; }
};

// (x, y) -> (a x - b y + c, b x + a y + d), in pixels.
struct Similarity {
  double a = 0, b = 0, c = 0, d = 0;
  bool is_inside(double x, double y, const AppearanceVector& image) const {
    const double u = a * x - b * y + c;
    const double v = b * x + a * y + d;
    return u >= 0 && v >= 0 && u < image.width_px && v < image.height_px;
  }
};

// Least squares. False when all matches lie on one point.
bool fit(const Moments& m, Similarity& fitted) {
  const auto spread = static_cast<double>(m.n * m.xx - m.x * m.x - m.y * m.y);
  if (!(spread > 0)) return false;
  const auto n = static_cast<double>(m.n);
  fitted.a = static_cast<double>(m.n * m.along - m.x * m.u - m.y * m.v) / spread;
  fitted.b = static_cast<double>(m.n * m.across - m.x * m.v + m.y * m.u) / spread;
  const auto x = static_cast<double>(m.x), y = static_cast<double>(m.y);
  fitted.c = (static_cast<double>(m.u) - fitted.a * x + fitted.b * y) / n / kPositionsPerPixel;
  fitted.d = (static_cast<double>(m.v) - fitted.b * x - fitted.a * y) / n / kPositionsPerPixel;
  return true;
}

double share_inside(const Similarity& s, const AppearanceVector& image, const AppearanceVector& other) {
  constexpr int kAcross = 8;
  constexpr int kDown = 6;
  int inside = 0;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kDown; ++j) {
      inside += s.is_inside((i + 0.5) * image.width_px / kAcross, (j + 0.5) * image.height_px / kDown, other) ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kAcross * kDown);
}

int features_inside(const Similarity& s, const AppearanceVector& image, const AppearanceVector& other) {
  return static_cast<int>(std::ranges::count_if(
      image.appearances, [&](const Appearance& p) { return s.is_inside(p.x_px, p.y_px, other); }));
}

// Of the matches' first ends, in diagonals of `image`.
double spread(const Moments& m, const AppearanceVector& image) {
  const auto n = static_cast<double>(m.n);
  const double width = static_cast<double>(image.width_px) * kPositionsPerPixel;
  const double height = static_cast<double>(image.height_px) * kPositionsPerPixel;
  const auto squares = static_cast<double>(m.n * m.xx - m.x * m.x - m.y * m.y);
  return std::sqrt(squares / (width * width + height * height)) / n;
}

}  // namespace

ViewOverlap view_overlap(const AppearanceVector& a, const AppearanceVector& b,
                         std::span<const std::pair<std::uint16_t, std::uint16_t>> inlier_matches) {
  Moments m;
  for (const auto& [i, j] : inlier_matches) {
    if (i >= a.appearances.size() || j >= b.appearances.size()) {
      throw std::invalid_argument("an edge's matches are not of its images");
    }
    const std::int64_t x = on_grid(a.appearances[i].x_px), y = on_grid(a.appearances[i].y_px);
    const std::int64_t u = on_grid(b.appearances[j].x_px), v = on_grid(b.appearances[j].y_px);
    ++m.n;
    m.x += x;
    m.y += y;
    m.u += u;
    m.v += v;
    m.xx += x * x + y * y;
    m.uu += u * u + v * v;
    m.along += x * u + y * v;
    m.across += x * v - y * u;
  }
  Similarity to_b, to_a;
  if (m.n == 0 || !fit(m, to_b) || !fit(m.exchanged(), to_a)) return {};
  ViewOverlap overlap;
  overlap.shared_view = std::min(share_inside(to_b, a, b), share_inside(to_a, b, a));
  const int features = std::min(features_inside(to_b, a, b), features_inside(to_a, b, a));
  if (features > 0) overlap.matched_share = std::min(1.0, static_cast<double>(m.n) / features);
  overlap.spread = std::min(spread(m, a), spread(m.exchanged(), b));
  return overlap;
}

}  // namespace mapweld
