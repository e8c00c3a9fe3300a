// The matches of one pair of images as columns of numbers, which is what every test of the geometry loops over.
//
// Coordinates are normalised: origin in the middle of the image, unit its diagonal. So thresholds are shares of the
// diagonal (0.005 is 2 px at 320 x 240) and images of different sizes meet on equal terms.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/feature_match.h"
#include "core/types.h"

namespace mapweld {

// Where normalised coordinates come from.
struct ImageFrame {
  double centre_x_px = 0;
  double centre_y_px = 0;
  double diagonal_px = 1;
};
ImageFrame frame_of(const AppearanceVector& image);

struct Correspondences {
  // Position in the first image and in the second.
  std::vector<float> xa, ya, xb, yb;
  // The similarity that SIFT's own scale and angle give: b - b0 = (m_re + i m_im) (a - a0), in normalised coordinates.
  std::vector<float> m_re, m_im;
  // Scale of the second over the first, in normalised coordinates: |m|.
  std::vector<float> ratio;

  std::size_t size() const { return xa.size(); }
};

Correspondences make_correspondences(const AppearanceVector& a, const AppearanceVector& b,
                                     const std::vector<FeatureMatch>& matches);

// The rows `chosen` of `all`.
Correspondences select(const Correspondences& all, const std::vector<std::uint32_t>& chosen);

}  // namespace mapweld
