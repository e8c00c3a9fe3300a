// Poses and turns that explain pairs of directions: what relative_pose.h decides between.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace mapweld {

// One point in space, as two cameras see it: unit vectors.
struct RayPair {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
};

// x_b = rotation x_a + length * direction, whatever the length.
struct FittedPose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d direction;  // unit; of the two signs the one that has more points in front of both cameras
  // Sum over the pairs of the squared distance in rad^2, at most max_distance^2 each, and so much for one behind a
  // camera.
  double error = 0;
};

// How far a pair is from the epipolar geometry: the least change of both directions, rad (Sampson 1982, on the sphere).
double epipolar_distance(const FittedPose& pose, const RayPair& pair);

// How far the direction may be off, rad: one standard deviation along its worse side, when directions of rays have
// `sigma` rad each. The pairs are those that fit.
double direction_sigma(const FittedPose& pose, std::span<const RayPair> pairs, double sigma);

// Whether the point lies before both cameras, or too far away to tell: the rays are within `tolerance` rad of parallel.
bool is_in_front(const FittedPose& pose, const RayPair& pair, double tolerance);

// Local optima of `error`, best first, equal ones once; empty when no five pairs determine a pose. Five pairs or more.
// Starts: five-point RANSAC (Nister 2004), the motions of a homography (Malis & Vargas 2007), the turn that fits best.
std::vector<FittedPose> fit_poses(std::span<const RayPair> pairs, double max_distance);

// The rotation that fits the pairs best when nothing but the camera's heading changed (Kabsch 1976, reweighted).
Eigen::Matrix3d fit_turn(std::span<const RayPair> pairs, double max_distance);

}  // namespace mapweld
