#include "core/geometry/correspondences.h"

#include <cmath>

#include "core/geometry/portable_math.h"

namespace mapweld {
ImageFrame frame_of(const AppearanceVector& image) {
  const double w = image.width_px;
  const double h = image.height_px;
  return {(w - 1) / 2, (h - 1) / 2, std::sqrt(w * w + h * h)};
}

Correspondences make_correspondences(const AppearanceVector& a, const AppearanceVector& b,
                                     const std::vector<FeatureMatch>& matches) {
  const ImageFrame fa = frame_of(a);
  const ImageFrame fb = frame_of(b);
  const std::size_t n = matches.size();
  Correspondences c;
  for (auto* column : {&c.xa, &c.ya, &c.xb, &c.yb, &c.m_re, &c.m_im, &c.ratio}) column->reserve(n);
  for (const FeatureMatch& m : matches) {
    const Appearance& p = a.appearances[m.a];
    const Appearance& q = b.appearances[m.b];
    c.xa.push_back(static_cast<float>((p.x_px - fa.centre_x_px) / fa.diagonal_px));
    c.ya.push_back(static_cast<float>((p.y_px - fa.centre_y_px) / fa.diagonal_px));
    c.xb.push_back(static_cast<float>((q.x_px - fb.centre_x_px) / fb.diagonal_px));
    c.yb.push_back(static_cast<float>((q.y_px - fb.centre_y_px) / fb.diagonal_px));
    const double ratio = (q.scale_px / fb.diagonal_px) / (p.scale_px / fa.diagonal_px);
    double turn_deg = static_cast<double>(q.angle_deg) - p.angle_deg;
    if (turn_deg < 0) turn_deg += 360;
    const Rotation r = portable_rotation(turn_deg);
    c.m_re.push_back(static_cast<float>(ratio * r.cos));
    c.m_im.push_back(static_cast<float>(ratio * r.sin));
    c.ratio.push_back(static_cast<float>(ratio));
  }
  return c;
}

Correspondences select(const Correspondences& all, const std::vector<std::uint32_t>& chosen) {
  Correspondences c;
  const auto take = [&](const std::vector<float>& from, std::vector<float>& to) {
    to.reserve(chosen.size());
    for (const std::uint32_t i : chosen) to.push_back(from[i]);
  };
  take(all.xa, c.xa);
  take(all.ya, c.ya);
  take(all.xb, c.xb);
  take(all.yb, c.yb);
  take(all.m_re, c.m_re);
  take(all.m_im, c.m_im);
  take(all.ratio, c.ratio);
  return c;
}

}  // namespace mapweld
