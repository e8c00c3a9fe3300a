#include "tests/support/rendering/rasterizer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mapweld::rendered {
namespace {

constexpr double kNear = 0.03;
constexpr int kSpan = 16;  // pixels between exact evaluations of light, texture level and perspective
constexpr int kMaxPortals = 24;

struct Point2 {
  double x;
  double y;
};

// A function that is linear over the image plane: value(x, y) = base + dx * x + dy * y.
struct Linear {
  double base;
  double dx;
  double dy;
  double at(double x, double y) const { return base + dx * x + dy * y; }
};

int exponent_of(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return exponent - 1;
}

// Nearest level for a footprint in texels.
int level_for(double texels, int levels) {
  if (!(texels > 1)) return 0;
  return std::clamp(exponent_of(texels * 1.4142), 0, levels - 1);
}

class Painter {
 public:
  Painter(const Scene& scene, const PinholeCamera& camera, const Shading& shading, Buffers& buffers)
      : scene_(scene), camera_(camera), shading_(shading), buffers_(buffers), on_path_(scene.cells.size()) {}

  // Draws a cell as it is seen between two columns, and what is seen through its portals. Cells are convex: no line of
  // sight enters one twice, so none is visited again on its own path.
  void visit(int index, double left, double right, int depth) {
    const Cell& cell = scene_.cells[static_cast<std::size_t>(index)];
    on_path_[static_cast<std::size_t>(index)] = 1;
    for (std::size_t i = 0; i < cell.surfaces.size(); ++i) {
      draw(cell.surfaces[i], cell.first_surface + static_cast<std::uint32_t>(i), left, right);
    }
    for (const Portal& portal : cell.portals) {
      if (depth == kMaxPortals || on_path_[static_cast<std::size_t>(portal.to)] != 0) continue;
      if (dot(portal.into, camera_.position - portal.lower_a) < -1e-6) continue;
      double from = left;
      double to = right;
      if (!narrow(portal, from, to)) continue;
      visit(portal.to, from, to, depth + 1);
    }
    on_path_[static_cast<std::size_t>(index)] = 0;
  }

 private:
  Vec3 to_camera(const Vec3& world) const {
    const Vec3 d = world - camera_.position;
    return {dot(d, camera_.right), dot(d, camera_.down), dot(d, camera_.forward)};
  }
  Point2 project(const Vec3& c) const {
    return {camera_.centre_x_px + camera_.focal_px * c.x / c.z, camera_.centre_y_px + camera_.focal_px * c.y / c.z};
  }

  // Clips a convex polygon against the near plane and projects it. Returns the number of vertices.
  int clip_and_project(const std::array<Vec3, 4>& corners, std::array<Point2, 8>& polygon) const {
    int count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3& a = corners[i];
      const Vec3& b = corners[(i + 1) % 4];
      if (a.z >= kNear) polygon[static_cast<std::size_t>(count++)] = project(a);
      if ((a.z >= kNear) != (b.z >= kNear)) {
        const double t = (kNear - a.z) / (b.z - a.z);
        polygon[static_cast<std::size_t>(count++)] = project(a + (b - a) * t);
      }
    }
    return count;
  }

  // Narrows the columns [from, to] to those through the portal. False if none are left.
  bool narrow(const Portal& portal, double& from, double& to) const {
    const Vec3& a = portal.lower_a;
    const Vec3& b = portal.upper_b;
    const std::array<Vec3, 4> corners{to_camera({a.x, a.y, a.z}), to_camera({b.x, b.y, a.z}),
                                      to_camera({b.x, b.y, b.z}), to_camera({a.x, a.y, b.z})};
    // On the threshold everything may be seen through the portal.
    if (std::abs(dot(portal.into, camera_.position - a)) < 2 * kNear) return true;
    std::array<Point2, 8> polygon;
    const int count = clip_and_project(corners, polygon);
    if (count < 3) return false;
    double low = polygon[0].x;
    double high = polygon[0].x;
    for (int i = 1; i < count; ++i) {
      low = std::min(low, polygon[static_cast<std::size_t>(i)].x);
      high = std::max(high, polygon[static_cast<std::size_t>(i)].x);
    }
    from = std::max(from, low - 0.5);
    to = std::min(to, high + 0.5);
    return from < to;
  }

  Light light_at(const Surface& s, double across_m, double down_m) const {
    const Light* grid = scene_.light.data() + s.first_light;
    if (s.light_columns == 1 && s.light_rows == 1) return grid[0];
    const double x = std::clamp(across_m / s.width_m * s.light_columns - 0.5, 0.0, s.light_columns - 1.0);
    const double y = std::clamp(down_m / s.height_m * s.light_rows - 0.5, 0.0, s.light_rows - 1.0);
    const int x0 = std::min(static_cast<int>(x), std::max(0, s.light_columns - 2));
    const int y0 = std::min(static_cast<int>(y), std::max(0, s.light_rows - 2));
    const int x1 = std::min(x0 + 1, s.light_columns - 1);
    const int y1 = std::min(y0 + 1, s.light_rows - 1);
    const auto fx = static_cast<float>(x - x0);
    const auto fy = static_cast<float>(y - y0);
    const auto mixed = [&](float Light::*part) {
      const float upper = grid[y0 * s.light_columns + x0].*part * (1 - fx) + grid[y0 * s.light_columns + x1].*part * fx;
      const float lower = grid[y1 * s.light_columns + x0].*part * (1 - fx) + grid[y1 * s.light_columns + x1].*part * fx;
      return upper * (1 - fy) + lower * fy;
    };
    return {mixed(&Light::lamps), mixed(&Light::daylight)};
  }

  // Brightness of a point, 256 = as painted.
  int brightness(const Surface& s, double across_m, double down_m) const {
    double value = 1;
    switch (s.glow) {
      case Glow::kLamp:
        value = std::min(1.6, 0.25 + 1.3 * shading_.lamps);
        break;
      case Glow::kDaylight:
        value = 0.25 + 1.1 * shading_.daylight;
        break;
      case Glow::kScreen:
        value = 1;
        break;
      case Glow::kNone: {
        const Light light = light_at(s, across_m, down_m);
        value = light.lamps * shading_.lamps + light.daylight * shading_.daylight;
      }
    }
    return static_cast<int>(std::clamp(value, 0.0, 4.0) * 256);
  }

  void draw(const Surface& s, std::uint32_t id, double left, double right) {
    const Vec3 normal = s.normal();
    const Vec3 to_corner = s.corner - camera_.position;
    const double distance = dot(normal, to_corner);
    if (distance > -1e-4) return;  // seen from behind or edge on

    const Vec3 a = to_camera(s.corner);
    const Vec3 across{dot(s.across, camera_.right), dot(s.across, camera_.down), dot(s.across, camera_.forward)};
    const Vec3 down{dot(s.down, camera_.right), dot(s.down, camera_.down), dot(s.down, camera_.forward)};
    const Vec3 b = a + across * s.width_m;
    const Vec3 c = b + down * s.height_m;
    const Vec3 d = a + down * s.height_m;
    if (a.z < kNear && b.z < kNear && c.z < kNear && d.z < kNear) return;
    std::array<Point2, 8> polygon;
    const int count = clip_and_project({a, b, c, d}, polygon);
    if (count < 3) return;

    double top = polygon[0].y;
    double bottom = top;
    double low = polygon[0].x;
    double high = low;
    for (int i = 1; i < count; ++i) {
      const Point2& p = polygon[static_cast<std::size_t>(i)];
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
      low = std::min(low, p.x);
      high = std::max(high, p.x);
    }
    if (high < left || low > right || bottom < -0.5 || top > camera_.height_px - 0.5) return;

    // With the ray of pixel (x, y) r = forward + right (x - cx) / f + down (y - cy) / f, the plane is met at depth z
    // with 1/z = n.r / n.(corner - camera); metres across, over z, are across.r - (across.(corner - camera)) / z.
    const double f = camera_.focal_px;
    const auto along_ray = [&](const Vec3& v, double scale) {
      const double dx = dot(v, camera_.right) / f * scale;
      const double dy = dot(v, camera_.down) / f * scale;
      return Linear{dot(v, camera_.forward) * scale - dx * camera_.centre_x_px - dy * camera_.centre_y_px, dx, dy};
    };
    const Linear inverse_z = along_ray(normal, 1 / distance);
    const auto over_z = [&](const Vec3& axis) {
      const Linear ray = along_ray(axis, 1);
      const double offset = dot(axis, to_corner);
      return Linear{ray.base - offset * inverse_z.base, ray.dx - offset * inverse_z.dx, ray.dy - offset * inverse_z.dy};
    };
    const Plane plane{inverse_z, over_z(s.across), over_z(s.down)};

    constexpr double kOverlap = 0.02;  // px: neighbours overlap by a hair, so that no crack shows
    const int first_row = std::max(0, static_cast<int>(std::ceil(top - kOverlap)));
    const int last_row = std::min(camera_.height_px - 1, static_cast<int>(std::floor(bottom + kOverlap)));
    for (int y = first_row; y <= last_row; ++y) {
      const double row = std::clamp(static_cast<double>(y), top, bottom);
      double from = 1e9;
      double to = -1e9;
      for (int i = 0; i < count; ++i) {
        const Point2& p = polygon[static_cast<std::size_t>(i)];
        const Point2& q = polygon[static_cast<std::size_t>((i + 1) % count)];
        if ((p.y < row && q.y < row) || (p.y > row && q.y > row)) continue;
        if (p.y == q.y) {
          from = std::min({from, p.x, q.x});
          to = std::max({to, p.x, q.x});
        } else {
          const double x = p.x + (q.x - p.x) * ((row - p.y) / (q.y - p.y));
          from = std::min(from, x);
          to = std::max(to, x);
        }
      }
      from = std::max({from - kOverlap, left, 0.0});
      to = std::min({to + kOverlap, right, camera_.width_px - 1.0});
      const int x0 = static_cast<int>(std::ceil(from));
      const int x1 = static_cast<int>(std::floor(to));
      if (x0 <= x1) draw_row(s, id, plane, x0, x1, y);
    }
  }

  struct Plane {
    Linear inverse_z;
    Linear across_over_z;
    Linear down_over_z;
  };

  void draw_row(const Surface& s, std::uint32_t id, const Plane& plane, int x0, int x1, int y) {
    for (int x = x0; x <= x1; x += kSpan) draw_span(s, id, plane, x, std::min(x + kSpan - 1, x1), y);
  }

  void draw_span(const Surface& s, std::uint32_t id, const Plane& plane, int x0, int x1, int y) {
    const std::size_t start =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width_px) + static_cast<std::size_t>(x0);
    float* depth = buffers_.inverse_depth.data() + start;
    std::uint32_t* surface = buffers_.surface.data() + start;
    const int count = x1 - x0 + 1;
    const double inverse_z0 = plane.inverse_z.at(x0, y);
    const auto base = static_cast<float>(inverse_z0);
    const auto step = static_cast<float>(plane.inverse_z.dx);

    bool any = false;
    for (int i = 0; i < count; ++i) any |= base + step * static_cast<float>(i) > depth[i];
    if (!any) return;
    if (!shading_.enabled && !s.texture->cut_out()) {
      for (int i = 0; i < count; ++i) {
        const float value = base + step * static_cast<float>(i);
        if (value > depth[i]) {
          depth[i] = value;
          surface[i] = id;
        }
      }
      return;
    }

    const double across0 = plane.across_over_z.at(x0, y);
    const double down0 = plane.down_over_z.at(x0, y);
    const double middle = 0.5 * (x0 + x1);
    const double z = 1 / std::max(1e-4, plane.inverse_z.at(middle, y));
    const double across = plane.across_over_z.at(middle, y) * z;
    const double down = plane.down_over_z.at(middle, y) * z;
    const auto footprint = [&](const Linear& over_z, double value, double per_m, int texels) {
      const double dx = std::abs((over_z.dx - value * plane.inverse_z.dx) * z);
      const double dy = std::abs((over_z.dy - value * plane.inverse_z.dy) * z);
      return std::max(dx, dy) * std::abs(per_m) * texels;
    };
    const Texture& texture = *s.texture;
    const int level_across =
        level_for(footprint(plane.across_over_z, across, s.u_per_m, texture.width()), texture.levels_across());
    const int level_down =
        level_for(footprint(plane.down_over_z, down, s.v_per_m, texture.height()), texture.levels_down());

    int light = 0;
    int light_step = 0;
    if (shading_.enabled) {
      const double z0 = 1 / std::max(1e-4, inverse_z0);
      light = brightness(s, across0 * z0, down0 * z0) << 8;
      if (count > 1 && s.glow == Glow::kNone) {
        const double z1 = 1 / std::max(1e-4, plane.inverse_z.at(x1, y));
        const int end = brightness(s, plane.across_over_z.at(x1, y) * z1, plane.down_over_z.at(x1, y) * z1) << 8;
        light_step = (end - light) / (count - 1);
      }
    }
    const auto u_base = static_cast<float>(across0 * s.u_per_m);
    const auto u_step = static_cast<float>(plane.across_over_z.dx * s.u_per_m);
    const auto v_base = static_cast<float>(down0 * s.v_per_m);
    const auto v_step = static_cast<float>(plane.down_over_z.dx * s.v_per_m);
    const auto u_offset = static_cast<float>(s.u_offset);
    const auto v_offset = static_cast<float>(s.v_offset);
    const bool cut_out = texture.cut_out();
    std::uint32_t* colour = buffers_.colour.data() + start;
    for (int i = 0; i < count; ++i, light += light_step) {
      const auto n = static_cast<float>(i);
      const float value = base + step * n;
      if (!(value > depth[i])) continue;
      const float pixel_z = 1.0F / value;
      const std::uint32_t texel = texture.sample((u_base + u_step * n) * pixel_z + u_offset,
                                                 (v_base + v_step * n) * pixel_z + v_offset, level_across, level_down);
      if (cut_out && texel < 0x80000000U) continue;
      depth[i] = value;
      surface[i] = id;
      if (!shading_.enabled) continue;
      const auto gain = static_cast<std::uint32_t>(light >> 8);
      const std::uint32_t red = std::min(255U, ((texel >> 16) & 255U) * gain >> 8);
      const std::uint32_t green = std::min(255U, ((texel >> 8) & 255U) * gain >> 8);
      const std::uint32_t blue = std::min(255U, (texel & 255U) * gain >> 8);
      colour[i] = red << 16 | green << 8 | blue;
    }
  }

  const Scene& scene_;
  const PinholeCamera& camera_;
  const Shading& shading_;
  Buffers& buffers_;
  std::vector<std::uint8_t> on_path_;  // by cell: 1 while it is being visited
};

}  // namespace

void rasterize(const Scene& scene, int cell, const PinholeCamera& camera, const Shading& shading, Buffers& buffers) {
  const std::size_t size = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  buffers.inverse_depth.assign(size, 0.0F);
  buffers.surface.assign(size, kNoSurface);
  if (shading.enabled) buffers.colour.assign(size, 0x202020U);
  Painter(scene, camera, shading, buffers).visit(cell, 0, camera.width_px - 1.0, 0);
}

}  // namespace mapweld::rendered
