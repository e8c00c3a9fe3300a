#include "core/geometry/pose/camera.h"

#include <cmath>

#include <opencv2/calib3d.hpp>

namespace mapweld {
namespace {

constexpr double kFurthestOffAxis = 5.67;  // tan(80 degrees)
constexpr double kReturns_px = 0.25;       // a direction has to come back to its pixel as near as that

cv::Matx33d matrix_of(const Camera& c) { return {c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1}; }

cv::Mat coefficients_of(const Camera& c) {
  const int n = c.model == CameraModel::kFisheye ? 4 : 5;
  return cv::Mat(n, 1, CV_64F, const_cast<double*>(c.distortion.data())).clone();
}

std::vector<cv::Point2d> undistorted(const Camera& c, const std::vector<cv::Point2d>& pixels) {
  std::vector<cv::Point2d> out;
  const cv::TermCriteria enough(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-3);
  if (c.model == CameraModel::kFisheye) {
    cv::fisheye::undistortPoints(pixels, out, matrix_of(c), coefficients_of(c));
  } else {
    cv::undistortPoints(pixels, out, matrix_of(c), coefficients_of(c), cv::noArray(), cv::noArray(), enough);
  }
  return out;
}

std::vector<cv::Point2d> distorted(const Camera& c, const std::vector<cv::Point2d>& rays) {
  std::vector<cv::Point2d> out;
  if (c.model == CameraModel::kFisheye) {
    cv::fisheye::distortPoints(rays, out, matrix_of(c), coefficients_of(c));
  } else {
    std::vector<cv::Point3d> directions;
    for (const cv::Point2d& r : rays) directions.emplace_back(r.x, r.y, 1);
    cv::projectPoints(directions, cv::Vec3d(), cv::Vec3d(), matrix_of(c), coefficients_of(c), out);
  }
  return out;
}

}  // namespace

std::vector<std::optional<Ray>> rays_of(const Camera& camera, std::span<const PointPx> points) {
  std::vector<std::optional<Ray>> rays(points.size());
  if (camera.model == CameraModel::kPinhole) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Ray ray{(points[i].x - camera.cx_px) / camera.fx_px, (points[i].y - camera.cy_px) / camera.fy_px};
      if (std::hypot(ray.x, ray.y) <= kFurthestOffAxis) rays[i] = ray;
    }
    return rays;
  }
  if (points.empty()) return rays;
  std::vector<cv::Point2d> pixels;
  for (const PointPx& p : points) pixels.emplace_back(p.x, p.y);
  const std::vector<cv::Point2d> found = undistorted(camera, pixels);
  const std::vector<cv::Point2d> back = distorted(camera, found);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::hypot(found[i].x, found[i].y) <= kFurthestOffAxis && cv::norm(back[i] - pixels[i]) <= kReturns_px) {
      rays[i] = Ray{found[i].x, found[i].y};
    }
  }
  return rays;
}

}  // namespace mapweld
