#include "tests/support/true_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mapweld::rendered {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

// Columns: right, down and forward in the world.
Matrix3 to_world(const Pose& pose) {
  const double ch = std::cos(pose.heading_deg / kDegrees), sh = std::sin(pose.heading_deg / kDegrees);
  const double cp = std::cos(pose.pitch_deg / kDegrees), sp = std::sin(pose.pitch_deg / kDegrees);
  return {sh, ch * sp, ch * cp, -ch, sh * sp, sh * cp, 0, -cp, sp};
}

}  // namespace

Camera camera_of(const CameraModel& model) {
  return {.fx_px = model.focal_px,
          .fy_px = model.focal_px,
          .cx_px = (model.width_px - 1) / 2.0,
          .cy_px = (model.height_px - 1) / 2.0};
}

std::array<double, 16> matrix_of(const Pose& pose) {
  const Matrix3 r = to_world(pose);
  return {r[0], r[1], r[2], pose.x_m, r[3], r[4], r[5], pose.y_m, r[6], r[7], r[8], pose.height_m, 0, 0, 0, 1};
}

TruePose true_pose(const Pose& a, const Pose& b) {
  const Matrix3 of_a = to_world(a), of_b = to_world(b);
  const std::array<double, 3> from_b = {a.x_m - b.x_m, a.y_m - b.y_m, a.height_m - b.height_m};
  TruePose truth;
  std::array<double, 3> t{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t i = 0; i < 3; ++i) {
      t[r] += of_b[3 * i + r] * from_b[i];
      for (std::size_t k = 0; k < 3; ++k) truth.rotation[3 * r + k] += of_b[3 * i + r] * of_a[3 * i + k];
    }
  }
  truth.distance_m = std::hypot(t[0], t[1], t[2]);
  if (truth.distance_m > 1e-9) {
    truth.direction = {t[0] / truth.distance_m, t[1] / truth.distance_m, t[2] / truth.distance_m};
  }
  return truth;
}

double angle_deg(const Matrix3& p, const Matrix3& q) {
  double trace = 0;
  for (std::size_t i = 0; i < 9; ++i) trace += p[i] * q[i];
  return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) * kDegrees;
}

double angle_deg(const std::array<double, 3>& p, const std::array<double, 3>& q) {
  return std::acos(std::clamp(p[0] * q[0] + p[1] * q[1] + p[2] * q[2], -1.0, 1.0)) * kDegrees;
}

}  // namespace mapweld::rendered
