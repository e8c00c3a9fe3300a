// Which links inside a map say that two of its vertices are at one place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/types.h"

namespace mapweld {

struct DriveLinkOptions {
  std::uint32_t longest_link = 30;         // AliasGuardOptions
  double revisit_fullness = 0.9;           // AliasGuardOptions
  double revisit_completeness = 0.9;       // AliasGuardOptions
  std::uint32_t min_revisit_images = 100;  // AliasGuardOptions
};

// The inner edges along the drive: those between images that their member took in at most longest_link apart; and those
// of the revisits. What looks alike is linked inside a map as well, and a revisit is told from it by its completeness:
// edges that close a longer loop form clusters (ends at most one hop apart, along the drive), and those of a
// cluster are taken when it has at least min_revisit_images images at its ends, and at least so great a share of them
// sees the other pass at least so fully, as a share of its features, as it sees its own neighbours. A look-alike place
// falls short where it differs.
std::vector<Edge> drive_links(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                              const AppearanceSource& appearances, const DriveLinkOptions& options);

// Those of `links` whose inliers are at least `min_share` of the features of the image that has fewer, and those of
// revisits: steps from which a place is still in view. Over the others a few hops lead from one end of a corridor to
// the other.
std::vector<Edge> short_links(const std::vector<MergeMember>& members, std::span<const Edge> links,
                              const AppearanceSource& appearances, double min_share, const DriveLinkOptions& options);

}  // namespace mapweld
