// The homography H of two views of a plane, or of a camera that only turned: x_b ~ H x_a (Hartley & Zisserman 2004,
// chapter 13).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/matrix3.h"

namespace mapweld {

// Least squares over four correspondences or more (normalised direct linear transform); none when they are degenerate.
std::optional<Matrix3> homography_from_many(const Correspondences& c, std::span<const std::uint32_t> chosen);

// Least squares affine transform over three correspondences or more, last row (0, 0, 1).
std::optional<Matrix3> affine_from_many(const Correspondences& c, std::span<const std::uint32_t> chosen);

// Squared distance of every correspondence to H, in shares of the diagonal: |H x_a - x_b|^2 in the second image. A
// point that H sends behind the camera is infinitely far.
void transfer_distances2(const Correspondences& c, const Matrix3& h, std::vector<float>& out);

struct RobustHomography {
  bool found = false;
  Matrix3 h{};
  std::vector<std::uint32_t> inliers;  // ascending
};

// The homography that most correspondences agree on: the similarity of the one match that most others agree with,
// grown by local optimisation to an affine transform and a homography. No random draws.
RobustHomography robust_homography(const Correspondences& c, float max_distance);

}  // namespace mapweld
