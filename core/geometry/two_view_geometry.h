// What relates two views: a fundamental matrix, or a homography where the scene is a plane or the camera only turned.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/matrix3.h"
#include "core/types.h"

namespace mapweld {

struct TwoViewOptions {
  // Of an inlier from its epipolar lines, and from where the homography sends it; shares of the diagonal, 2 px and
  // 4 px at 320 x 240. The homography gets more room: few scenes are flat, and a word's features lie where the
  // detector put them, not where a matcher refined them.
  double fundamental_distance = 0.005;
  double homography_distance = 0.01;
  // Flat: the homography explains at least this share of the inliers of the fundamental matrix, which then says
  // nothing that the homography does not (Torr 1999; Chum, Werner & Matas 2005).
  double flat_share = 0.9;
};

struct TwoViewGeometry {
  GeometryKind kind = GeometryKind::kNone;
  Matrix3 matrix{};                    // in normalised coordinates
  std::vector<std::uint32_t> inliers;  // ascending
  double log10_false_alarms = 0;       // of the more significant of the two models; +infinity when there is none
};

// Estimates both models from `c` and judges them by chance among `matches` matches, of which `c` are those that may be
// inliers; `background` is what chance looks like (false_alarms.h). Every random draw comes from `seed`.
TwoViewGeometry estimate_two_view_geometry(const Correspondences& c, int matches, const Correspondences& background,
                                           std::uint64_t seed, const TwoViewOptions& options);

// The same geometry in pixels of the two images.
std::array<double, 9> in_pixels(const TwoViewGeometry& geometry, const AppearanceVector& a, const AppearanceVector& b);

}  // namespace mapweld
