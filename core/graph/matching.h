// Maximum matchings: how many independent joins hold two maps together.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "core/types.h"

namespace mapweld {

// Size of a maximum matching of the graph with these edges; loops and repeated edges do not count. Between two maps
// the graph is bipartite, and by Koenig's theorem the number is also the least number of images whose removal
// splits them again (the paper's entanglement).
//
// Begins where Karp & Sipser 1981 end, which is seldom more than a few edges short, and goes on by Edmonds' augmenting
// paths (Boost.Graph): O(E) to begin with, and about as much for every edge that was missing.
std::uint32_t maximum_matching(std::span<const std::pair<VertexId, VertexId>> edges);

}  // namespace mapweld
