// What the renderer draws: textured rectangles, gathered in convex cells that open into each other through portals.
//
// Coordinates in metres: x east, y north, z up, z = 0 on the floor of the storey. Every storey is a scene of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tests/support/rendering/texture.h"

namespace mapweld::rendered {

struct Vec3 {
  double x = 0;
  double y = 0;
  double z = 0;
  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
};
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// An axis-aligned rectangle of the floor.
struct Area {
  double x0 = 0;
  double y0 = 0;
  double x1 = 0;
  double y1 = 0;
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  bool contains(double x, double y, double margin = 0) const {
    return x >= x0 + margin && x <= x1 - margin && y >= y0 + margin && y <= y1 - margin;
  }
};

// What makes a surface bright.
enum class Glow : std::uint8_t {
  kNone,      // the light that falls on it
  kLamp,      // it is a lamp
  kDaylight,  // it is a window
  kScreen,    // it shines by itself, whatever the light
};

// Light on a point of a surface, in two parts that a robot's hour of the day weighs: lamps and daylight.
struct Light {
  float lamps = 1;
  float daylight = 0;
};

// A textured rectangle, seen from its front only.
struct Surface {
  Vec3 corner;  // upper left, as seen from the front
  Vec3 across;  // unit, to the right
  Vec3 down;    // unit, at a right angle to `across`
  double width_m = 0;
  double height_m = 0;
  const Texture* texture = nullptr;
  double u_per_m = 0;  // texture coordinates are u = u_offset + u_per_m * metres across, likewise v
  double v_per_m = 0;
  double u_offset = 0;
  double v_offset = 0;
  Glow glow = Glow::kNone;
  int light_columns = 0;  // grid of light over the surface, at least 1 x 1, row by row, from light[first_light] on
  int light_rows = 0;
  std::size_t first_light = 0;

  Vec3 normal() const { return cross(down, across); }  // towards the viewer
};

// An opening to another cell: a vertical rectangle.
struct Portal {
  int to = 0;
  Vec3 lower_a;
  Vec3 upper_b;
  Vec3 into;  // unit normal, towards the inside of the cell that owns the portal
};

struct Lamp {
  Vec3 position;
  double power = 1;
  bool daylight = false;
  Vec3 direction{0, 0, -1};  // where it shines
};

// A convex part of the floor plan: a room or a stretch of corridor.
struct Cell {
  Area area;
  double height_m = 2.8;
  std::vector<Surface> surfaces;  // what stands in front first, floor, walls and ceiling last
  std::vector<Portal> portals;
  std::vector<Lamp> lamps;
  std::vector<Area> footprints;     // what a robot cannot stand in
  std::uint32_t first_surface = 0;  // number of its first surface in the storey
};

struct Scene {
  std::vector<Cell> cells;
  std::vector<Light> light;
  std::uint32_t surface_count = 0;
};

}  // namespace mapweld::rendered
