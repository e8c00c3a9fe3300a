// Maximum matchings: how many independent joins hold two maps together.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/types.h"

namespace mapweld {

// Size of a maximum matching of the graph with these edges; loops and repeated edges do not count. Between two maps
// the graph is bipartite, and by Koenig's theorem the number is also the least number of images whose removal
// splits them again (the paper's entanglement).
//
// Bipartite graphs by Hopcroft & Karp 1973, O(E sqrt(V)); others, which only merges of three and more maps give, by
// Edmonds' blossoms, O(V^3) over the vertices that have an edge.
std::uint32_t maximum_matching(std::span<const std::pair<VertexId, VertexId>> edges);

}  // namespace mapweld
