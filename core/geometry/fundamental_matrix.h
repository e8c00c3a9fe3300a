// The fundamental matrix F of two views: x_b^T F x_a = 0 (Hartley & Zisserman 2004, chapters 9 and 11).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/matrix3.h"

namespace mapweld {

// The up to three matrices through seven correspondences (Hartley & Zisserman, 11.1.2); none when they are degenerate.
// `out` has room for three; returns how many.
int fundamental_from_seven(const Correspondences& c, const std::array<std::uint32_t, 7>& sample,
                           std::array<Matrix3, 3>& out);

// Least squares over eight correspondences or more, then made singular (the normalised eight-point algorithm).
std::optional<Matrix3> fundamental_from_many(const Correspondences& c, std::span<const std::uint32_t> chosen);

// Squared distance of every correspondence to F, in shares of the diagonal: the larger of the distances of its two
// points from their epipolar lines.
void epipolar_distances2(const Correspondences& c, const Matrix3& f, std::vector<float>& out);

}  // namespace mapweld
