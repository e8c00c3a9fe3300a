// How two cameras of a rendered world really stand to each other, in the convention of core/geometry/pose.
#pragma once

#include <array>
#include <optional>

#include "core/geometry/matrix3.h"
#include "core/geometry/pose/camera.h"
#include "tests/support/rendered_world.h"

namespace mapweld::rendered {

Camera camera_of(const CameraModel& model);

// Camera to world (x east, y north, z up), row-major: what a pose of the contract is.
std::array<double, 16> matrix_of(const Pose& pose);

struct TruePose {
  Matrix3 rotation{};                              // x_b = rotation x_a + t
  std::optional<std::array<double, 3>> direction;  // of t; none where both stand on one spot
  double distance_m = 0;                           // |t|
};
TruePose true_pose(const Pose& a, const Pose& b);

double angle_deg(const Matrix3& p, const Matrix3& q);  // of the rotation between them
double angle_deg(const std::array<double, 3>& p, const std::array<double, 3>& q);

}  // namespace mapweld::rendered
