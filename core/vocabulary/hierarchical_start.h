// The start of k-means: FLANN's hierarchical clustering (Muja & Lowe 2009).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mapweld {

// Up to `clusters` centres of `rows` (N x 128 bytes): a k-means tree, cut where the variance is least. FLANN returns
// (branching - 1) * k + 1 of them for some k, so a few may be missing. Repeatable: centres are chosen by k-means++ from
// std::rand, seeded; nothing else in the process may draw from it meanwhile.
std::vector<std::uint8_t> cluster_hierarchically(std::span<const std::uint8_t> rows, std::uint32_t clusters,
                                                 std::uint32_t seed);

}  // namespace mapweld
