// What a map learns of its camera: features that are in every picture, wherever it was taken.
//
// A feature is static when it lies at the same place of the frame, with the same descriptor, in images that are no
// neighbours. It is marked when its image is inserted, and neither votes nor matches from then on
// (AppearanceVector::static_appearances). A verdict on a pair leaves out what the two have at the same place
// (core/geometry/static_matches.h); what is marked is left out of every pair, also where the other image has it
// elsewhere, or not at all, and makes no candidates.
#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/static_matches.h"
#include "core/mapping/map_view.h"
#include "core/types.h"

namespace mapweld {

// Measured, see docs/pictures.md, "What is in every picture".
struct StaticContentOptions {
  // So many vertices are looked at, or up to twice as many: evenly spread over the map, and nearly the same ones as it
  // grows, so that they are in memory.
  std::uint32_t sample = 16;
  int fewest_images = 4;  // of them, no neighbours of the image nor of each other, that have the feature
  // Images that have more of their features in common at the same places show the same view, linked or not, and teach
  // nothing: a share of the features of the one that has fewer.
  double same_view = 0.6;
  StaticMatchOptions match = {.max_distance = 20};
};

// An image as it comes, with what `map` takes for static already set apart: features that enough of the vertices looked
// at have among theirs. For images to be inserted, and for queries. Pure; where nothing is marked, nothing is compared.
AppearanceVector with_known_static(AppearanceVector image, const MapView& map,
                                   const StaticContentOptions& options = {});

// Looks for more in `image`, the next vertex of `map`, which was verified with `linked`, and sets that apart as well. A
// vertex is a neighbour of another one, or of the image, when it is linked with it or with one that is. Returns whether
// there was any. Pure: depends on the map's images and verified edges alone, not on what is thought of these.
bool learn_static(AppearanceVector& image, std::span<const VertexId> linked, const MapView& map,
                  const StaticContentOptions& options = {});

// How much of the frame is static, 0..1: the share of its cells (16 x 12) in which two or more of the images have a
// static feature.
double static_share(std::span<const AppearanceVector> images);

}  // namespace mapweld
