// With what camera an image was taken, where, and how two cameras stand to each other.
//
// Camera coordinates are those of computer vision: x to the right, y down, z forward, the eye in the origin. Metres.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/contract/codec.h"

namespace mapweld::contract {

// Of the image as it stands upright, in its own pixels: the centre of the upper left one is (0, 0).
struct Camera {
  // "pinhole"; "opencv": distortion k1, k2, p1, p2 and perhaps k3; "fisheye": k1, k2, k3, k4. As in OpenCV.
  std::string model;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  std::vector<double> distortion;
  static constexpr auto fields() {
    using C = Camera;
    return std::tuple(field("model", &C::model), field("fx_px", &C::fx_px), field("fy_px", &C::fy_px),
                      field("cx_px", &C::cx_px), field("cy_px", &C::cy_px), field("distortion", &C::distortion));
  }
  friend bool operator==(const Camera&, const Camera&) = default;
};

// Where an image was taken. `matrix_4x4`, by rows, takes camera coordinates to those of the frame.
struct Pose {
  std::string frame;  // what the coordinates are of; two poses with the same name are of one frame
  std::vector<std::vector<double>> matrix_4x4;
  static constexpr auto fields() {
    return std::tuple(required("frame", &Pose::frame), required("matrix_4x4", &Pose::matrix_4x4));
  }
  friend bool operator==(const Pose&, const Pose&) = default;
};

// How two cameras stand to each other, as far as the images tell: what is at x in the coordinates of the first is at
// rotation_3x3 x + s direction in those of the second, for some length s > 0 that images do not tell. `direction`, of
// length 1, points to the first camera as the second sees it.
struct RelativePose {
  std::vector<std::vector<double>> rotation_3x3;  // by rows
  std::optional<std::vector<double>> direction;   // null: for all the images say, the camera only turned
  double parallax_deg = 0;                        // by how much directions differ beside the rotation, median
  int inliers = 0;                                // matches that agree
  static constexpr auto fields() {
    using R = RelativePose;
    return std::tuple(field("rotation_3x3", &R::rotation_3x3), field("direction", &R::direction),
                      field("parallax_deg", &R::parallax_deg), field("inliers", &R::inliers));
  }
  friend bool operator==(const RelativePose&, const RelativePose&) = default;
};

// One image of a batch, beside its bytes.
struct ImageMetadata {
  std::optional<Camera> camera;
  std::optional<Pose> pose;
  static constexpr auto fields() {
    return std::tuple(omitted_when_empty("camera", &ImageMetadata::camera),
                      omitted_when_empty("pose", &ImageMetadata::pose));
  }
  friend bool operator==(const ImageMetadata&, const ImageMetadata&) = default;
};

// Throw ContractError(invalid_parameter); the detail names the field, inside `name`, and what it must be. A principal
// point may lie outside of its image, but no further than a crop of the greatest images puts it. A rotation has to be
// one within 0.001.
void check(const Camera& camera, std::string_view name = "camera");
void check(const Pose& pose, std::string_view name = "pose");
void check(const ImageMetadata& metadata, std::string_view name);

}  // namespace mapweld::contract
