// A calibrated camera: from pixels to directions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mapweld {

// How a camera bends what it sees; the models and their coefficients are OpenCV's.
enum class CameraModel : std::uint8_t {
  kPinhole,  // no distortion
  kOpencv,   // k1, k2, p1, p2, k3
  kFisheye,  // k1, k2, k3, k4 (Kannala & Brandt 2006)
};

// Pixels as everywhere: the centre of the upper left one is (0, 0).
struct Camera {
  CameraModel model = CameraModel::kPinhole;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  std::array<double, 5> distortion{};  // those that the model has not are 0
  friend bool operator==(const Camera&, const Camera&) = default;
};

struct PointPx {
  double x = 0;
  double y = 0;
};

// The direction in which a point lies that is seen at a pixel, as (x/z, y/z): x right, y down, z forward.
struct Ray {
  double x = 0;
  double y = 0;
};

// nullopt where the camera has no such direction: the distortion cannot be undone there, or it is more than 80 degrees
// off the axis.
std::vector<std::optional<Ray>> rays_of(const Camera& camera, std::span<const PointPx> points);

}  // namespace mapweld
