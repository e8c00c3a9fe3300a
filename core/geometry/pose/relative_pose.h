// How two calibrated cameras stand to each other, as far as the matches of their images determine it.
//
// A point at x_a in the first camera's coordinates (x right, y down, z forward) is at x_b = R x_a + t in the second's.
// t points to where the first camera is, as the second sees it; images tell its direction, not its length.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "core/geometry/matrix3.h"
#include "core/geometry/pose/camera.h"
#include "core/types.h"

namespace mapweld {

// Defaults measured, see docs/verification.md.
struct RelativePoseOptions {
  double max_distance = 0.005;  // of an inlier from its epipolar line, a share of the diagonal: 2 px at 320 x 240
  // The direction is told when the matches deviate from a mere turn by at least so many times what chance would have
  // them, and when so much is one standard deviation of it at most, by what they deviate from the epipolar geometry
  // (where features lie is not quite by chance: real errors are some three times as large).
  double min_deviation = 4;
  double max_sigma_deg = 1;
  // Features do not stay alike over more: matches that say so are of things that only look alike, or too few to tell.
  double max_parallax_deg = 40;
  // Another pose as likely as the best: it explains the matches as well but for so many squared standard deviations,
  // and differs by more than `other_deg` in rotation or direction. Two views of a plane have two.
  double doubt = 4;
  double other_deg = 10;
};

struct RelativePose {
  Matrix3 rotation{};                              // R
  std::optional<std::array<double, 3>> direction;  // t, of length 1; none where the camera only turned, for all we see
  double parallax_deg = 0;                         // median angle between R x_a and x_b over the inliers
  int inliers = 0;                                 // matches that agree, in front of both cameras
  double deviation = 0;  // what min_deviation is asked of; about 1 where the camera only turned
  double sigma_deg = 0;  // what max_sigma_deg is asked of
};

// nullopt where there is too little to go by (fewer than eight inliers), or two poses explain the matches as well, or
// the best one is beyond max_parallax_deg. `matches`: indices into a.appearances and b.appearances, std::out_of_range
// for one beyond them (a damaged store). A pure function: every random draw has a fixed seed. Exchanging the images
// inverts the pose, up to rounding and draws.
std::optional<RelativePose> relative_pose(const AppearanceVector& a, const Camera& camera_a, const AppearanceVector& b,
                                          const Camera& camera_b,
                                          std::span<const std::pair<std::uint16_t, std::uint16_t>> matches,
                                          const RelativePoseOptions& options = {});

}  // namespace mapweld
