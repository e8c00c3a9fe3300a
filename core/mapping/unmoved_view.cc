#include "core/mapping/unmoved_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mapweld {
namespace {

constexpr double kMegapixel = 1 << 20;

// Within so many pixels of the images as they are, for one in pixels of the images that features are found in.
double scaled(double length_px, const AppearanceVector& image) {
  return length_px * std::sqrt(std::max(1.0, static_cast<double>(image.width_px) * image.height_px / kMegapixel));
}

}  // namespace

bool is_unmoved_view(const AppearanceVector& a, const AppearanceVector& b, const Verification& verification,
                     const UnmovedViewOptions& options) {
  if (a.width_px != b.width_px || a.height_px != b.height_px) return false;
  const std::size_t fewer = std::min(a.appearances.size(), b.appearances.size());
  const std::size_t inliers = verification.inlier_matches.size();
  if (inliers == 0 || static_cast<double>(inliers) < options.min_matched_share * static_cast<double>(fewer))
    return false;

  // Coordinates lie on a grid of eighths, so that squares are exact.
  std::vector<double> squares;
  squares.reserve(inliers);
  for (const auto& [i, j] : verification.inlier_matches) {
    const double x = double{a.appearances[i].x_px} - b.appearances[j].x_px;
    const double y = double{a.appearances[i].y_px} - b.appearances[j].y_px;
    squares.push_back(x * x + y * y);
  }
  const auto within = [&](double length_px) {
    const double limit = scaled(length_px, a);
    return static_cast<double>(std::ranges::count_if(squares, [&](double square) { return square <= limit * limit; }));
  };
  const auto all = static_cast<double>(inliers);
  return within(options.three_quarters_within_px) >= 0.75 * all && within(options.nine_tenths_within_px) >= 0.9 * all;
}

}  // namespace mapweld
