#include "tests/support/rendering/builder.h"

#include <algorithm>

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
namespace {
constexpr Vec3 kDown{0, 0, -1};
}  // namespace

WallFrame WallFrame::turned(double angle_deg) const {
  const double c = cos_deg(angle_deg);
  const double s = sin_deg(angle_deg);
  const auto turn = [c, s](const Vec3& v) { return Vec3{c * v.x - s * v.y, s * v.x + c * v.y, 0}; };
  return {origin, turn(along), turn(out)};
}

void Builder::add(const Vec3& corner, const Vec3& across, const Vec3& down, double width, double height,
                  const Skin& skin) {
  if (width <= 1e-6 || height <= 1e-6) return;
  Surface surface;
  surface.corner = corner;
  surface.across = across;
  surface.down = down;
  surface.width_m = width;
  surface.height_m = height;
  surface.texture = skin.texture;
  surface.glow = skin.glow;
  if (skin.tile_m > 0) {
    surface.u_per_m = 1 / skin.tile_m;
    if (skin.tile_down_m > 0) {
      surface.v_per_m = 1 / skin.tile_down_m;
      surface.u_offset = skin.u_offset;
      surface.v_offset = skin.v_offset;
    } else {
      // Different boxes of one material show different parts of it.
      Random random(hash_of(width * 1000, height * 1000, corner.z * 1000));
      surface.v_per_m = 1 / skin.tile_m;
      surface.u_offset = random.uniform();
      surface.v_offset = random.uniform();
    }
  } else {
    surface.u_per_m = 1 / width;
    surface.v_per_m = 1 / height;
  }
  cell_.surfaces.push_back(surface);
}

void Builder::panel(const WallFrame& f, const Span& s, double t, const Span& z, const Skin& skin) {
  add(f.at(s.from, t, z.to), f.along, kDown, s.length(), z.length(), skin);
}

void Builder::sheet(const WallFrame& f, const Span& s, const Span& t, double z, const Skin& skin, bool from_above) {
  if (from_above) {
    add(f.at(s.from, t.from, z), f.along, f.out, s.length(), t.length(), skin);
  } else {
    add(f.at(s.from, t.to, z), f.along, f.out * -1, s.length(), t.length(), skin);
  }
}

void Builder::box(const WallFrame& f, const Span& s, const Span& t, const Span& z, const BoxSkin& skin, bool bottom) {
  add(f.at(s.from, t.to, z.to), f.along, kDown, s.length(), z.length(), skin.front);
  add(f.at(s.from, t.from, z.to), f.out, kDown, t.length(), z.length(), skin.sides);
  add(f.at(s.to, t.to, z.to), f.out * -1, kDown, t.length(), z.length(), skin.sides);
  add(f.at(s.to, t.from, z.to), f.along * -1, kDown, s.length(), z.length(), skin.back);
  sheet(f, s, t, z.to, skin.top);
  if (bottom) sheet(f, s, t, z.from, skin.sides, false);
}

void Builder::cut_out(const WallFrame& f, double s, double t, double width, const Span& z, double angle_deg,
                      const Skin& skin) {
  const WallFrame turned = f.moved(s, t).turned(angle_deg);
  panel(turned, {-width / 2, width / 2}, 0, z, skin);
  panel(turned.opposite(0, 0), {-width / 2, width / 2}, 0, z, skin);
}

void Builder::block(const WallFrame& f, const Span& s, const Span& t) {
  const Vec3 a = f.at(s.from, t.from, 0);
  const Vec3 b = f.at(s.to, t.to, 0);
  const Vec3 c = f.at(s.from, t.to, 0);
  const Vec3 d = f.at(s.to, t.from, 0);
  cell_.footprints.push_back({std::min({a.x, b.x, c.x, d.x}), std::min({a.y, b.y, c.y, d.y}),
                              std::max({a.x, b.x, c.x, d.x}), std::max({a.y, b.y, c.y, d.y})});
}

}  // namespace mapweld::rendered
