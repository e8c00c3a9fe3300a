// How much of two images is the same view, as far as their matches tell.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/types.h"

namespace mapweld {

// Symmetric: exchanging the images (and the ends of the matches) gives the same value, bit for bit, in whatever order
// the matches come.
struct ViewOverlap {
  // The share of either image that lies inside the other when it is laid over it by the similarity transform that
  // fits the matches best; the smaller of the two shares, 0..1. Crude where the scene is deep, but it tells a
  // thing seen from afar in the corner of another view from a view seen twice.
  double shared_view = 0;
  // Of the features that lie inside the other image, laid over it so, the share that is matched; with the image that
  // has fewer of them, 0..1. A view seen twice matches all over; where but one thing is the same, or the matches agree
  // by chance, all the other features around them find no partner.
  double matched_share = 0;
  // Root mean square distance of the matches from their centre, in diagonals of the image; in the image where they lie
  // closer together.
  double spread = 0;
};

// `inlier_matches`: indices into a.appearances and b.appearances; std::invalid_argument for one that is beyond them (a
// damaged store). O(matches + features).
ViewOverlap view_overlap(const AppearanceVector& a, const AppearanceVector& b,
                         std::span<const std::pair<std::uint16_t, std::uint16_t>> inlier_matches);

// Where the features of an image are, by coordinate.
struct FeaturePlaces {
  explicit FeaturePlaces(const AppearanceVector& image);
  int width_px, height_px;
  std::vector<float> x_px, y_px;
};

// ViewOverlap::matched_share alone.
double matched_share(const FeaturePlaces& a, const FeaturePlaces& b,
                     std::span<const std::pair<std::uint16_t, std::uint16_t>> matches);

}  // namespace mapweld
