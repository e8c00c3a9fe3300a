// Draws a scene into colour, depth and surface buffers: portals decide which cells are seen, a depth buffer the rest.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/rendering/scene.h"

namespace mapweld::rendered {

// A pinhole camera, square pixels; pixel centres at whole numbers, as everywhere in the project.
struct PinholeCamera {
  Vec3 position;
  Vec3 forward;  // unit vectors at right angles
  Vec3 right;
  Vec3 down;
  double focal_px = 0;
  double centre_x_px = 0;
  double centre_y_px = 0;
  int width_px = 0;
  int height_px = 0;
};

inline constexpr std::uint32_t kNoSurface = 0xffffffffU;

// Row-major, width x height.
struct Buffers {
  std::vector<float> inverse_depth;    // 1/m along the optical axis, 0: nothing
  std::vector<std::uint32_t> surface;  // number of the surface in the scene, or kNoSurface
  std::vector<std::uint32_t> colour;   // 0x..RRGGBB; untouched without shading
};

struct Shading {
  bool enabled = true;
  double lamps = 1;     // weight of the lamps' light
  double daylight = 1;  // weight of the windows' light
};

// Draws what a camera in `cell` sees. One sample a pixel. Pure; threads may call it at once on one scene.
void rasterize(const Scene& scene, int cell, const PinholeCamera& camera, const Shading& shading, Buffers& buffers);

}  // namespace mapweld::rendered
