// Features and their words become the appearance vector of an image (paper, section III-A).
#pragma once

#include <span>

#include "core/types.h"

namespace mapweld {

// The grid on which appearances lie: positions in 1/8 px (u16), scales in 1/64 px (u16, at most 1023), angles in
// 360/65536 degrees (u16). Far finer than SIFT's own accuracy; makes stored and fresh appearances equal bit for bit.
inline constexpr float kPositionsPerPixel = 8.0f;
inline constexpr float kScalesPerPixel = 64.0f;
inline constexpr float kAnglesPerDegree = 65536.0f / 360.0f;

// The keypoint with word `word`, snapped to the grid; without a signature.
Appearance snap_to_grid(WordId word, const Keypoint& keypoint);

// One appearance a feature, snapped, sorted; with the signatures of the descriptors, if there are any. `words[i]`
// belongs to `features.keypoints[i]`.
AppearanceVector make_appearance_vector(const Features& features, std::span<const WordId> words);

}  // namespace mapweld
