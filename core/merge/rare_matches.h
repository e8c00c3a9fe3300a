// How many matches of an edge rest on words that its maps have nowhere else.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/hop_balls.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/merge/word_places.h"

namespace mapweld {

// For each of `edges`: the inliers whose word occurs, in either end's map, within the ball around that end only.
// `member_of`: by merged vertex.
std::vector<int> rare_matches(std::span<const MergeEdge* const> edges, const AppearanceSource& appearances,
                              const WordPlaces& places, std::span<const std::uint32_t> member_of, HopBalls& balls);

}  // namespace mapweld
