#include "core/geometry/pose/relative_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "core/geometry/pair_verifier.h"
#include "core/geometry/pose/pose_fit.h"

namespace mapweld {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Parallax that less than a fifth of the matches show may be wrong matches that slid along their epipolar lines. Of the
// lengths of two errors with standard deviation 1, so many are below sqrt(-2 ln(1 - share)) (Rayleigh).
constexpr double kShare = 0.8;
constexpr double kRayleigh = 1.794;
constexpr double kDegrees = 180 / std::numbers::pi;

std::vector<PointPx> points_of(const AppearanceVector& image,
                               std::span<const std::pair<std::uint16_t, std::uint16_t>> matches,
                               std::uint16_t std::pair<std::uint16_t, std::uint16_t>::*end) {
  std::vector<PointPx> points;
  points.reserve(matches.size());
  for (const auto& match : matches) {
    const Appearance& appearance = image.appearances.at(match.*end);
    points.push_back({.x = appearance.x_px, .y = appearance.y_px});
  }
  return points;
}

// A share of the image's diagonal as an angle, on the axis.
double as_angle(double share, const AppearanceVector& image, const Camera& camera) {
  return share * std::hypot(image.width_px, image.height_px) / std::sqrt(camera.fx_px * camera.fy_px);
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::ranges::nth_element(values, at);
  return *at;
}

double angle_between(const Vector3d& p, const Vector3d& q) { return std::atan2(p.cross(q).norm(), p.dot(q)); }

double angle_of(const Matrix3d& rotation) { return Eigen::AngleAxisd(rotation).angle(); }

}  // namespace

std::optional<RelativePose> relative_pose(const AppearanceVector& a, const Camera& camera_a, const AppearanceVector& b,
                                          const Camera& camera_b,
                                          std::span<const std::pair<std::uint16_t, std::uint16_t>> matches,
                                          const RelativePoseOptions& options) {
  using Match = std::pair<std::uint16_t, std::uint16_t>;
  const auto rays_a = rays_of(camera_a, points_of(a, matches, &Match::first));
  const auto rays_b = rays_of(camera_b, points_of(b, matches, &Match::second));
  std::vector<RayPair> pairs;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!rays_a[i] || !rays_b[i]) continue;
    pairs.push_back({.a = Vector3d(rays_a[i]->x, rays_a[i]->y, 1).normalized(),
                     .b = Vector3d(rays_b[i]->x, rays_b[i]->y, 1).normalized()});
  }
  if (pairs.size() < static_cast<std::size_t>(kFewestInliers)) return std::nullopt;
  const double max_distance =
      std::max(as_angle(options.max_distance, a, camera_a), as_angle(options.max_distance, b, camera_b));

  const std::vector<FittedPose> poses = fit_poses(pairs, max_distance);
  if (poses.empty()) return std::nullopt;
  const FittedPose& best = poses.front();
  std::vector<RayPair> inliers;
  std::vector<double> distances, parallax;
  for (const RayPair& pair : pairs) {
    const double d = epipolar_distance(best, pair);
    if (d > max_distance || !is_in_front(best, pair, max_distance)) continue;
    inliers.push_back(pair);
    distances.push_back(d);
    parallax.push_back(angle_between(best.rotation * pair.a, pair.b));
  }
  if (inliers.size() < static_cast<std::size_t>(kFewestInliers)) return std::nullopt;

  // The standard deviation of a direction, from the distances; five of their freedoms went into the pose.
  const double n = static_cast<double>(inliers.size());
  const double floor = as_angle(0.0002, a, camera_a);
  const double sigma = std::max(1.4826 * quantile(distances, 0.5) * std::sqrt(n / (n - 5)), floor);

  const Matrix3d turn = fit_turn(inliers, max_distance);
  std::vector<double> off_turn;
  for (const RayPair& pair : inliers) off_turn.push_back(angle_between(turn * pair.a, pair.b));
  const double deviation = quantile(off_turn, kShare) / (kRayleigh * std::numbers::sqrt2 * sigma);

  RelativePose pose;
  pose.inliers = static_cast<int>(inliers.size());
  pose.parallax_deg = quantile(parallax, 0.5) * kDegrees;
  pose.deviation = deviation;
  pose.sigma_deg = direction_sigma(best, inliers, sigma) * kDegrees;
  const bool only_turned = deviation < options.min_deviation;
  if (!only_turned) {
    if (pose.parallax_deg > options.max_parallax_deg) return std::nullopt;
    for (const FittedPose& other : poses) {
      const double apart = std::max(angle_of(other.rotation * best.rotation.transpose()),
                                    angle_between(other.direction, best.direction));
      if (apart * kDegrees > options.other_deg && other.error - best.error <= options.doubt * sigma * sigma) {
        return std::nullopt;
      }
    }
    if (pose.sigma_deg <= options.max_sigma_deg) {
      pose.direction = {best.direction.x(), best.direction.y(), best.direction.z()};
    }
  }
  const Matrix3d& rotation = only_turned ? turn : best.rotation;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) pose.rotation[static_cast<std::size_t>(3 * r + k)] = rotation(r, k);
  }
  return pose;
}

}  // namespace mapweld
