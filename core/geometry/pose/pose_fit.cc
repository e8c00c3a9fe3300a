#include "core/geometry/pose/pose_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Dense>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace mapweld {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Pairs = std::span<const RayPair>;

constexpr double kSame = 1e-3;  // poses that differ less, in rad, are one

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Of b^T E a: its value over the length of its gradient along both spheres.
struct Sampson {
  double distance = 0;
  double gradient = 0;
};

Sampson sampson(const Matrix3d& essential, const RayPair& pair) {
  const Vector3d to_b = essential * pair.a;
  const Vector3d to_a = essential.transpose() * pair.b;
  const double value = pair.b.dot(to_b);
  const double gradient = std::sqrt(to_a.squaredNorm() + to_b.squaredNorm() - 2 * value * value);
  return {.distance = value / std::max(gradient, 1e-12), .gradient = std::max(gradient, 1e-12)};
}

// Two unit vectors at right angles to `v` and to each other, as columns.
Eigen::Matrix<double, 3, 2> tangents(const Vector3d& v) {
  Eigen::Index least = 0;
  v.cwiseAbs().minCoeff(&least);
  const Vector3d first = v.cross(Vector3d::Unit(least)).normalized();
  Eigen::Matrix<double, 3, 2> columns;
  columns << first, v.cross(first);
  return columns;
}

Matrix3d turned(const Matrix3d& rotation, const Vector3d& by) {
  const double angle = by.norm();
  if (!(angle > 0)) return rotation;
  return Eigen::AngleAxisd(angle, by / angle).toRotationMatrix() * rotation;
}

// What is made small: Cauchy's function of the distances.
double robust_error(const FittedPose& pose, Pairs pairs, double scale) {
  const Matrix3d essential = cross_matrix(pose.direction) * pose.rotation;
  double sum = 0;
  for (const RayPair& pair : pairs) {
    const double d = sampson(essential, pair).distance / scale;
    sum += std::log1p(d * d);
  }
  return sum;
}

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

// How a distance changes with three angles of the rotation and with two of the direction, `along`.
Vector5 slope(const FittedPose& pose, const Eigen::Matrix<double, 3, 2>& along, const RayPair& pair, const Sampson& s) {
  const Vector3d p = pose.rotation * pair.a;
  Vector5 row;
  row << p.cross(pair.b.cross(pose.direction)), along.transpose() * p.cross(pair.b);
  return row / s.gradient;
}

// Levenberg & Marquardt over three angles of the rotation and two of the direction.
void refine(FittedPose& pose, Pairs pairs, double scale) {
  double error = robust_error(pose, pairs, scale);
  double damping = 1e-4;
  for (int step = 0; step < 30; ++step) {
    const Matrix3d essential = cross_matrix(pose.direction) * pose.rotation;
    const Eigen::Matrix<double, 3, 2> along = tangents(pose.direction);
    Matrix5 normal = Matrix5::Zero();
    Vector5 downhill = Vector5::Zero();
    for (const RayPair& pair : pairs) {
      const Sampson s = sampson(essential, pair);
      const Vector5 row = slope(pose, along, pair, s);
      const double d = s.distance / scale;
      const double weight = 1 / (1 + d * d);
      normal += weight * row * row.transpose();
      downhill -= weight * s.distance * row;
    }
    Matrix5 damped = normal;
    damped.diagonal() += damping * (normal.diagonal().array() + 1e-9).matrix();
    const Vector5 change = damped.ldlt().solve(downhill);
    if (!change.allFinite()) return;
    FittedPose next = pose;
    next.rotation = turned(pose.rotation, change.head<3>());
    next.direction = (pose.direction + along * change.tail<2>()).normalized();
    const double next_error = robust_error(next, pairs, scale);
    if (next_error < error) {
      const bool settled = error - next_error < 1e-9 * error;
      pose = next;
      error = next_error;
      damping = std::max(damping / 10, 1e-9);
      if (settled) return;
    } else {
      damping *= 10;
      if (damping > 1e6) return;
    }
  }
}

// Chooses the sign of the direction, and says what is left.
void judge(FittedPose& pose, Pairs pairs, double max_distance) {
  const double most = max_distance * max_distance;
  double error_of[2];
  for (double& error : error_of) {
    error = 0;
    for (const RayPair& pair : pairs) {
      const double d = epipolar_distance(pose, pair);
      error += is_in_front(pose, pair, max_distance) ? std::min(d * d, most) : most;
    }
    pose.direction = -pose.direction;
  }
  if (error_of[1] < error_of[0]) pose.direction = -pose.direction;
  pose.error = std::min(error_of[0], error_of[1]);
}

// The direction that fits best beside a rotation.
Vector3d direction_beside(const Matrix3d& rotation, Pairs pairs) {
  Matrix3d sum = Matrix3d::Zero();
  for (const RayPair& pair : pairs) {
    const Vector3d normal = (rotation * pair.a).cross(pair.b);
    sum += normal * normal.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(sum).eigenvectors().col(0);
}

std::vector<FittedPose> starts(Pairs pairs, double max_distance) {
  std::vector<FittedPose> poses;
  const auto add = [&](const cv::Mat& rotation, const cv::Mat& direction) {
    FittedPose pose;
    cv::cv2eigen(rotation, pose.rotation);
    cv::cv2eigen(direction, pose.direction);
    if (!(pose.direction.norm() > 1e-9) || !pose.rotation.allFinite() || pose.rotation.determinant() < 0) return;
    pose.direction.normalize();
    poses.push_back(pose);
  };
  const Matrix3d turn = fit_turn(pairs, max_distance);
  poses.push_back({.rotation = turn, .direction = direction_beside(turn, pairs)});

  std::vector<cv::Point2d> a, b;
  for (const RayPair& pair : pairs) {
    a.emplace_back(pair.a.x() / pair.a.z(), pair.a.y() / pair.a.z());
    b.emplace_back(pair.b.x() / pair.b.z(), pair.b.y() / pair.b.z());
  }
  const cv::Mat identity = cv::Mat::eye(3, 3, CV_64F);
  const cv::Mat essential = cv::findEssentialMat(a, b, identity, cv::RANSAC, 0.999, max_distance);
  if (essential.rows >= 3) {
    cv::Mat first, second, direction;
    cv::decomposeEssentialMat(essential.rowRange(0, 3), first, second, direction);
    add(first, direction);
    add(second, direction);
  }
  const cv::Mat plane = cv::findHomography(a, b, cv::RANSAC, 2 * max_distance);
  if (!plane.empty()) {
    std::vector<cv::Mat> rotations, directions, normals;
    cv::decomposeHomographyMat(plane, identity, rotations, directions, normals);
    for (std::size_t i = 0; i < rotations.size(); ++i) add(rotations[i], directions[i]);
  }
  return poses;
}

bool are_same(const FittedPose& p, const FittedPose& q) {
  return (p.rotation - q.rotation).norm() < kSame && (p.direction - q.direction).norm() < kSame;
}

}  // namespace

double epipolar_distance(const FittedPose& pose, const RayPair& pair) {
  return std::fabs(sampson(cross_matrix(pose.direction) * pose.rotation, pair).distance);
}

double direction_sigma(const FittedPose& pose, Pairs pairs, double sigma) {
  const Matrix3d essential = cross_matrix(pose.direction) * pose.rotation;
  const Eigen::Matrix<double, 3, 2> along = tangents(pose.direction);
  Matrix5 information = Matrix5::Zero();
  for (const RayPair& pair : pairs) {
    const Vector5 row = slope(pose, along, pair, sampson(essential, pair));
    information += row * row.transpose();
  }
  // What is known of the direction when the rotation is not.
  const Eigen::Matrix2d left = information.bottomRightCorner<2, 2>() -
                               information.bottomLeftCorner<2, 3>() *
                                   information.topLeftCorner<3, 3>().ldlt().solve(information.topRightCorner<3, 2>());
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(left).eigenvalues()(0);
  return least > 0 ? sigma / std::sqrt(least) : std::numbers::pi;
}

bool is_in_front(const FittedPose& pose, const RayPair& pair, double tolerance) {
  const Vector3d p = pose.rotation * pair.a;
  const Vector3d across = p.cross(pair.b);
  if (across.norm() <= tolerance) return p.dot(pair.b) > 0;
  // Lengths along both rays, times across^2: from  length_b b = length_a p + t.
  const double length_a = pair.b.cross(pose.direction).dot(across);
  const double length_b = p.cross(pose.direction).dot(across);
  return length_a > 0 && length_b > 0;
}

std::vector<FittedPose> fit_poses(Pairs pairs, double max_distance) {
  if (pairs.size() < 5) return {};
  std::vector<FittedPose> found;
  for (FittedPose pose : starts(pairs, max_distance)) {
    refine(pose, pairs, max_distance / 2);
    judge(pose, pairs, max_distance);
    if (std::ranges::none_of(found, [&](const FittedPose& other) { return are_same(pose, other); }))
      found.push_back(pose);
  }
  std::ranges::stable_sort(found, {}, &FittedPose::error);
  return found;
}

Matrix3d fit_turn(Pairs pairs, double max_distance) {
  Matrix3d rotation = Matrix3d::Identity();
  for (int round = 0; round < 10; ++round) {
    Matrix3d sum = Matrix3d::Zero();
    for (const RayPair& pair : pairs) {
      const double d = (rotation * pair.a - pair.b).norm() / max_distance;
      sum += (round == 0 ? 1 : 1 / (1 + d * d)) * pair.b * pair.a.transpose();
    }
    const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
    rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  }
  return rotation;
}

}  // namespace mapweld
