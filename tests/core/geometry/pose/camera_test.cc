#include "core/geometry/pose/camera.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

TEST(Camera, APinholeSeesAlongStraightLines) {
  const Camera camera{.fx_px = 200, .fy_px = 100, .cx_px = 160, .cy_px = 120};
  const std::vector<PointPx> points{{160, 120}, {360, 220}, {160 - 2000, 120}};
  const auto rays = rays_of(camera, points);
  ASSERT_EQ(rays.size(), 3U);
  EXPECT_DOUBLE_EQ(rays[0]->x, 0);
  EXPECT_DOUBLE_EQ(rays[0]->y, 0);
  EXPECT_DOUBLE_EQ(rays[1]->x, 1);
  EXPECT_DOUBLE_EQ(rays[1]->y, 1);
  EXPECT_FALSE(rays[2]) << "84 degrees off the axis";
}

// The models written down here once more, as the papers have them.
PointPx by_polynomial(const Camera& c, Ray ray) {
  const auto [k1, k2, p1, p2, k3] = c.distortion;
  const double r2 = ray.x * ray.x + ray.y * ray.y;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double x = ray.x * radial + 2 * p1 * ray.x * ray.y + p2 * (r2 + 2 * ray.x * ray.x);
  const double y = ray.y * radial + p1 * (r2 + 2 * ray.y * ray.y) + 2 * p2 * ray.x * ray.y;
  return {c.fx_px * x + c.cx_px, c.fy_px * y + c.cy_px};
}

PointPx by_angle(const Camera& c, Ray ray) {
  const double r = std::hypot(ray.x, ray.y);
  const double theta = std::atan(r), t2 = theta * theta;
  const double bent =
      theta * (1 + t2 * (c.distortion[0] + t2 * (c.distortion[1] + t2 * (c.distortion[2] + t2 * c.distortion[3]))));
  const double scale = r > 0 ? bent / r : 1;
  return {c.fx_px * ray.x * scale + c.cx_px, c.fy_px * ray.y * scale + c.cy_px};
}

void expect_undone(const Camera& camera, PointPx (*bend)(const Camera&, Ray), double reach) {
  std::vector<Ray> truth;
  std::vector<PointPx> points;
  for (int i = -5; i <= 5; ++i) {
    for (int j = -5; j <= 5; ++j) {
      truth.push_back({reach * i / 5, reach * j / 5});
      points.push_back(bend(camera, truth.back()));
    }
  }
  const auto rays = rays_of(camera, points);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    ASSERT_TRUE(rays[i]) << i;
    EXPECT_NEAR(rays[i]->x, truth[i].x, 1e-4) << i;
    EXPECT_NEAR(rays[i]->y, truth[i].y, 1e-4) << i;
  }
}

TEST(Camera, PolynomialDistortionIsUndone) {
  expect_undone({.model = CameraModel::kOpencv,
                 .fx_px = 517,
                 .fy_px = 516,
                 .cx_px = 318,
                 .cy_px = 255,
                 .distortion = {-0.28, 0.07, 0.0018, -0.0002, -0.005}},
                by_polynomial, 0.6);
}

TEST(Camera, FisheyeDistortionIsUndone) {
  expect_undone({.model = CameraModel::kFisheye,
                 .fx_px = 190,
                 .fy_px = 191,
                 .cx_px = 254,
                 .cy_px = 256,
                 .distortion = {0.0034, 0.0007, -0.002, 0.0002}},
                by_angle, 1.8);
}

TEST(Camera, WhereTheLensHasNoDirectionThereIsNone) {
  // r (1 - 0.5 r^2) never exceeds 0.55: the corners are not reached by any ray.
  const Camera camera{.model = CameraModel::kOpencv,
                      .fx_px = 100,
                      .fy_px = 100,
                      .cx_px = 100,
                      .cy_px = 100,
                      .distortion = {-0.5, 0, 0, 0, 0}};
  const std::vector<PointPx> points{{110, 100}, {190, 100}, {190, 190}};
  const auto rays = rays_of(camera, points);
  EXPECT_TRUE(rays[0]);
  EXPECT_FALSE(rays[1]);
  EXPECT_FALSE(rays[2]);
}

}  // namespace
}  // namespace mapweld
