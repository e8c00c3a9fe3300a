#include "core/geometry/view_overlap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "core/vocabulary/appearance_vector.h"
#include "core/wide_loops.h"

namespace mapweld {
namespace {

using Matches = std::span<const std::pair<std::uint16_t, std::uint16_t>>;

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
  // Whether a point is inside a frame. No branch: many are asked for in one loop.
  MAPWELD_INLINE inline bool is_inside(double x, double y, double width_px, double height_px) const {
    const double u = a * x - b * y + c;
    const double v = b * x + a * y + d;
    return static_cast<bool>((u >= 0) & (v >= 0) & (u < width_px) & (v < height_px));
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

double share_inside(const Similarity& s, const FeaturePlaces& image, const FeaturePlaces& other) {
  constexpr int kAcross = 8;
  constexpr int kDown = 6;
  int inside = 0;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kDown; ++j) {
      const double x = (i + 0.5) * image.width_px / kAcross, y = (j + 0.5) * image.height_px / kDown;
      inside += s.is_inside(x, y, other.width_px, other.height_px) ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kAcross * kDown);
}

std::int64_t features_inside(const Similarity& s, const FeaturePlaces& image, const FeaturePlaces& other) {
  const double width_px = other.width_px, height_px = other.height_px;
  return wide_loops([&]() MAPWELD_INLINE {
    std::int64_t inside = 0;
    for (std::size_t i = 0; i < image.x_px.size(); ++i) {
      inside += s.is_inside(image.x_px[i], image.y_px[i], width_px, height_px) ? 1 : 0;
    }
    return inside;
  });
}

// Of the matches' first ends, in diagonals of `image`.
double spread(const Moments& m, const FeaturePlaces& image) {
  const auto n = static_cast<double>(m.n);
  const double width = static_cast<double>(image.width_px) * kPositionsPerPixel;
  const double height = static_cast<double>(image.height_px) * kPositionsPerPixel;
  const auto squares = static_cast<double>(m.n * m.xx - m.x * m.x - m.y * m.y);
  return std::sqrt(squares / (width * width + height * height)) / n;
}

// The matches, and either image laid over the other by them.
struct Overlay {
  Moments moments;
  Similarity to_b, to_a;
  bool is_fitted = false;  // nothing fits none, or matches that all lie on one point
};

Overlay lay_over(const FeaturePlaces& a, const FeaturePlaces& b, Matches matches) {
  Overlay overlay;
  Moments& m = overlay.moments;
  for (const auto& [i, j] : matches) {
    if (i >= a.x_px.size() || j >= b.x_px.size()) {
      throw std::invalid_argument("an edge's matches are not of its images");
    }
    const std::int64_t x = on_grid(a.x_px[i]), y = on_grid(a.y_px[i]);
    const std::int64_t u = on_grid(b.x_px[j]), v = on_grid(b.y_px[j]);
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
  overlay.is_fitted = m.n > 0 && fit(m, overlay.to_b) && fit(m.exchanged(), overlay.to_a);
  return overlay;
}

double matched_share(const Overlay& overlay, const FeaturePlaces& a, const FeaturePlaces& b) {
  const std::int64_t features = std::min(features_inside(overlay.to_b, a, b), features_inside(overlay.to_a, b, a));
  return features > 0 ? std::min(1.0, static_cast<double>(overlay.moments.n) / static_cast<double>(features)) : 0;
}

}  // namespace

FeaturePlaces::FeaturePlaces(const AppearanceVector& image) : width_px(image.width_px), height_px(image.height_px) {
  x_px.reserve(image.appearances.size());
  y_px.reserve(image.appearances.size());
  for (const Appearance& p : image.appearances) {
    x_px.push_back(p.x_px);
    y_px.push_back(p.y_px);
  }
}

ViewOverlap view_overlap(const AppearanceVector& image_a, const AppearanceVector& image_b, Matches inlier_matches) {
  const FeaturePlaces a(image_a), b(image_b);
  const Overlay overlay = lay_over(a, b, inlier_matches);
  if (!overlay.is_fitted) return {};
  return {.shared_view = std::min(share_inside(overlay.to_b, a, b), share_inside(overlay.to_a, b, a)),
          .matched_share = matched_share(overlay, a, b),
          .spread = std::min(spread(overlay.moments, a), spread(overlay.moments.exchanged(), b))};
}

double matched_share(const FeaturePlaces& a, const FeaturePlaces& b, Matches matches) {
  const Overlay overlay = lay_over(a, b, matches);
  return overlay.is_fitted ? matched_share(overlay, a, b) : 0;
}

}  // namespace mapweld
