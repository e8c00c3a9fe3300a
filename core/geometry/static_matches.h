// Features that two images have at the same place of their frames: what a camera carries with it, or a view that has
// not moved.
//
// A camera's own text, a logo, the robot's body, a mirror match between any two of its images, without displacement.
// Such matches are no evidence that two images show one place, unless the rest of the view does the same: a robot that
// stands still has every image like the last, all over the frame.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/word_matches.h"
#include "core/types.h"

namespace mapweld {

// Measured, see docs/verification.md, "Static content". Frames of different sizes are laid over each other; lengths are
// shares of the diagonal.
struct StaticMatchOptions {
  float max_displacement = 0.004f;  // between two features at one place: 1.6 px at 320 x 240
  float max_turn_deg = 15;          // between their angles
  float max_ratio = 1.3f;           // between their scales
  int max_distance = 28;            // between their signatures, bits of 128
  // Features so near to a static one, in either image, are left out with it: they mix what the camera carries with what
  // lies behind.
  float surroundings = 0.012f;
  // Fewer change nothing: some come by chance, or lie where a robot drives to.
  int few = 5;
  // The same view: the frame (8 x 6 cells) agrees wherever there is something to see. A cell agrees when so many of its
  // features have a partner in the other image, as above but for this displacement.
  float agreeing_displacement = 0.02f;
  float agreeing_features = 0.4f;
  float agreeing_cells = 0.55f;  // of all cells that have a feature
  int fewest_cells = 14;         // what a camera carries with it seldom fills more
  // A view that moves by a little shows it: where so many partners are displaced, one to eight at the same place or
  // more, less has to agree.
  int displaced = 8;
  float agreeing_cells_displaced = 0.45f;
  int fewest_cells_displaced = 10;
};

// Two images without their static features: what is left of their appearances.
struct WithoutStatic {
  AppearanceVector a;
  AppearanceVector b;
  // The appearance that each one left was: indices into those of the images as they came, ascending.
  std::vector<std::uint16_t> index_a;
  std::vector<std::uint16_t> index_b;
};

// What is left of a pair of images when features at the same place of both are left out; nullopt when there is nothing
// to leave out: there are but a few, or the whole view is the same. Symmetric. O(features) where images have little in
// common. What is known to be static (AppearanceVector::static_appearances) is never left; it counts where
// places and views are compared.
std::optional<WithoutStatic> without_static(const AppearanceVector& a, const AppearanceVector& b,
                                            const StaticMatchOptions& options);
// The same; `common`: the words that the appearances of both have.
std::optional<WithoutStatic> without_static(const AppearanceVector& a, const AppearanceVector& b,
                                            std::span<const CommonWord> common, const StaticMatchOptions& options);

// For each appearance of `image`, whether `other` has one like it at the same place, known to be static or not: 1 or 0.
std::vector<std::uint8_t> at_same_place(const AppearanceVector& image, const AppearanceVector& other,
                                        const StaticMatchOptions& options);

}  // namespace mapweld
