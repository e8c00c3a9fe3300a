#include "tests/support/rendering/lighting.h"

#include <algorithm>
#include <cmath>

namespace mapweld::rendered {
namespace {

constexpr double kGrid = 0.5;  // m between light samples on large surfaces

int samples(double length) { return length < 0.6 ? 1 : std::clamp(static_cast<int>(length / kGrid) + 1, 2, 160); }

Light light_on(const Cell& cell, const Vec3& point, const Vec3& normal) {
  // Light that has been reflected to and fro: more comes from the bright upper half of a room.
  double lamps = 0.62 + 0.06 * normal.z;
  if (normal.z < -0.5) lamps += 0.25;
  double daylight = 0;
  for (const Lamp& lamp : cell.lamps) {
    const Vec3 to_lamp = lamp.position - point;
    const double distance2 = dot(to_lamp, to_lamp);
    const double distance = std::sqrt(distance2);
    if (distance < 1e-6) continue;
    const double received = dot(to_lamp, normal) / distance;
    const double emitted = -dot(to_lamp, lamp.direction) / distance;
    const double light = lamp.power * std::max(0.0, received) * std::max(0.0, emitted) / (distance2 + 0.6);
    if (lamp.daylight) {
      daylight += light + 0.05 * lamp.power / (1 + 0.1 * distance2);
    } else {
      lamps += light;
    }
  }
  if (normal.z > 0.5 && point.z < 0.05) {
    for (const Area& area : cell.footprints) {
      if (area.contains(point.x, point.y, -0.1)) {
        lamps *= 0.6;
        daylight *= 0.6;
        break;
      }
    }
  }
  // Corners below the ceiling and above the floor are a little darker.
  if (std::abs(normal.z) < 0.5) {
    const double edge = std::min(point.z, cell.height_m - point.z);
    lamps *= 0.82 + 0.18 * std::min(1.0, edge / 0.6);
  }
  return {static_cast<float>(lamps), static_cast<float>(daylight)};
}

}  // namespace

void light_scene(Scene& scene) {
  scene.surface_count = 0;
  scene.light.clear();
  for (Cell& cell : scene.cells) {
    // What stands in front is small: drawing it first saves drawing the walls behind it.
    std::stable_sort(cell.surfaces.begin(), cell.surfaces.end(), [](const Surface& a, const Surface& b) {
      return a.width_m * a.height_m < b.width_m * b.height_m;
    });
    cell.first_surface = scene.surface_count;
    scene.surface_count += static_cast<std::uint32_t>(cell.surfaces.size());
    for (Surface& s : cell.surfaces) {
      s.light_columns = samples(s.width_m);
      s.light_rows = samples(s.height_m);
      s.first_light = scene.light.size();
      const Vec3 normal = s.normal();
      for (int row = 0; row < s.light_rows; ++row) {
        for (int column = 0; column < s.light_columns; ++column) {
          const Vec3 point = s.corner + s.across * (s.width_m * (column + 0.5) / s.light_columns) +
                             s.down * (s.height_m * (row + 0.5) / s.light_rows);
          scene.light.push_back(light_on(cell, point, normal));
        }
      }
    }
  }
}

}  // namespace mapweld::rendered
