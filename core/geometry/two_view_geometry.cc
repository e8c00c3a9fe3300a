#include "core/geometry/two_view_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/geometry/false_alarms.h"
#include "core/geometry/fundamental_matrix.h"
#include "core/geometry/homography.h"
#include "core/geometry/robust_fundamental.h"

namespace mapweld {
namespace {

// Significance is looked for up to twice an inlier's distance.
double log10_false_alarms(std::vector<float> distances2, int matches, std::span<const float> background_distances2,
                          const ModelClass& model, double inlier_distance) {
  distances2.resize(static_cast<std::size_t>(matches), std::numeric_limits<float>::infinity());
  std::ranges::sort(distances2);
  const Background background(background_distances2, model.dimension);
  return significance(distances2, model, background, 2 * inlier_distance).log10_false_alarms;
}

}  // namespace

TwoViewGeometry estimate_two_view_geometry(const Correspondences& c, int matches, const Correspondences& background,
                                           std::uint64_t seed, const TwoViewOptions& options) {
  TwoViewGeometry result{.kind = GeometryKind::kNone,
                         .matrix = {},
                         .inliers = {},
                         .log10_false_alarms = std::numeric_limits<double>::infinity()};
  std::vector<float> d2;
  std::vector<float> background_d2;

  const RobustHomography plane = robust_homography(c, static_cast<float>(options.homography_distance));
  std::vector<float> plane_d2;
  if (plane.found) {
    transfer_distances2(c, plane.h, plane_d2);
    transfer_distances2(background, plane.h, background_d2);
    result.log10_false_alarms = log10_false_alarms(
        plane_d2, matches, background_d2, {.sample = 4, .solutions = 1, .dimension = 2}, options.homography_distance);
    result.kind = GeometryKind::kHomography;
    result.matrix = plane.h;
    result.inliers = plane.inliers;
  }

  const RobustFundamental epipolar =
      robust_fundamental(c, seed, {.max_distance = static_cast<float>(options.fundamental_distance)});
  if (!epipolar.found) return result;
  epipolar_distances2(c, epipolar.f, d2);
  epipolar_distances2(background, epipolar.f, background_d2);
  result.log10_false_alarms =
      std::min(result.log10_false_alarms,
               log10_false_alarms(d2, matches, background_d2, {.sample = 7, .solutions = 3, .dimension = 1},
                                  options.fundamental_distance));
  const float flat2 = static_cast<float>(options.homography_distance * options.homography_distance);
  const auto on_plane =
      std::ranges::count_if(epipolar.inliers, [&](std::uint32_t i) { return plane.found && plane_d2[i] <= flat2; });
  const bool flat = static_cast<double>(on_plane) >= options.flat_share * static_cast<double>(epipolar.inliers.size());
  if (!plane.found || (!flat && epipolar.inliers.size() > plane.inliers.size())) {
    result.kind = GeometryKind::kFundamental;
    result.matrix = epipolar.f;
    result.inliers = epipolar.inliers;
  }
  return result;
}

std::array<double, 9> in_pixels(const TwoViewGeometry& geometry, const AppearanceVector& a, const AppearanceVector& b) {
  const ImageFrame fa = frame_of(a);
  const ImageFrame fb = frame_of(b);
  const Matrix3& m = geometry.matrix;
  // To normalised coordinates of a: x = (x_px - centre) / diagonal.
  Matrix3 right;
  for (int r = 0; r < 3; ++r) {
    right[3 * r] = m[3 * r] / fa.diagonal_px;
    right[3 * r + 1] = m[3 * r + 1] / fa.diagonal_px;
    right[3 * r + 2] = m[3 * r + 2] - right[3 * r] * fa.centre_x_px - right[3 * r + 1] * fa.centre_y_px;
  }
  Matrix3 out;
  for (int k = 0; k < 3; ++k) {
    if (geometry.kind == GeometryKind::kHomography) {  // and back to pixels of b
      out[k] = right[k] * fb.diagonal_px + right[6 + k] * fb.centre_x_px;
      out[3 + k] = right[3 + k] * fb.diagonal_px + right[6 + k] * fb.centre_y_px;
      out[6 + k] = right[6 + k];
    } else {  // the transposed map from the left
      out[k] = right[k] / fb.diagonal_px;
      out[3 + k] = right[3 + k] / fb.diagonal_px;
      out[6 + k] = right[6 + k] - out[k] * fb.centre_x_px - out[3 + k] * fb.centre_y_px;
    }
  }
  double norm = 0;
  for (const double v : out) norm += v * v;
  norm = std::sqrt(norm);
  if (norm > 0) {
    for (double& v : out) v /= norm;
  }
  return out;
}

}  // namespace mapweld
