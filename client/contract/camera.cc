#include "client/contract/camera.h"

#include <cmath>
#include <cstddef>

#include "client/contract/checks.h"
#include "client/contract/names.h"

namespace mapweld::contract {
namespace {

constexpr double kRotationWithin = 1e-3;

[[noreturn]] void refuse(const std::string& field, const std::string& must) {
  throw ContractError("invalid_parameter", "\"" + field + "\" must " + must + ".");
}

void check_rotation(const std::vector<std::vector<double>>& m, const std::string& field) {
  const auto row_times_row = [&](std::size_t i, std::size_t j) {
    return m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
  };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      if (!(std::fabs(row_times_row(i, j) - (i == j ? 1 : 0)) <= kRotationWithin)) {
        refuse(field, "begin with a rotation: rows of length 1 at right angles, within 0.001");
      }
    }
  }
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  if (determinant < 0) refuse(field, "begin with a rotation, not a reflection");
}

}  // namespace

void check(const Camera& camera, std::string_view name) {
  const std::string inside = std::string(name) + ".";
  check_one_of(camera.model, inside + "model", {"pinhole", "opencv", "fisheye"});
  for (const auto& [field, value] : {std::pair("fx_px", camera.fx_px), {"fy_px", camera.fy_px}}) {
    if (!(value > 0)) refuse(inside + field, "be greater than 0");
    check_range(std::optional(value), inside + field, 1.0, 1e6);
  }
  for (const auto& [field, value] : {std::pair("cx_px", camera.cx_px), {"cy_px", camera.cy_px}}) {
    check_range(std::optional(value), inside + field, -8192.0, 16384.0);
  }
  const std::size_t given = camera.distortion.size();
  const bool fits = camera.model == "pinhole"  ? given == 0
                    : camera.model == "opencv" ? given == 4 || given == 5
                                               : given == 4;
  if (!fits) {
    refuse(inside + "distortion",
           "have as many numbers as the model: none of a pinhole, k1, k2, p1, p2 and perhaps k3 "
           "of opencv, k1 to k4 of a fisheye");
  }
  for (const double value : camera.distortion) check_range(std::optional(value), inside + "distortion", -100.0, 100.0);
}

void check(const Pose& pose, std::string_view name) {
  const std::string field = std::string(name) + ".matrix_4x4";
  if (!is_image_name(pose.frame)) {
    refuse(std::string(name) + ".frame", "be 1 to 255 bytes of UTF-8 without control characters");
  }
  bool is_4x4 = pose.matrix_4x4.size() == 4;
  for (const std::vector<double>& row : pose.matrix_4x4) is_4x4 = is_4x4 && row.size() == 4;
  if (!is_4x4) refuse(field, "be four rows of four numbers");
  for (const std::vector<double>& row : pose.matrix_4x4) {
    for (const double value : row) check_range(std::optional(value), field, -1e9, 1e9);
  }
  if (pose.matrix_4x4[3] != std::vector<double>{0, 0, 0, 1}) refuse(field, "end with the row 0, 0, 0, 1");
  check_rotation(pose.matrix_4x4, field);
}

void check(const ImageMetadata& metadata, std::string_view name) {
  if (metadata.camera) check(*metadata.camera, std::string(name) + ".camera");
  if (metadata.pose) check(*metadata.pose, std::string(name) + ".pose");
}

}  // namespace mapweld::contract
