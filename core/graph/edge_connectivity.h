// Edge connectivity: the least number of edges whose removal disconnects the graph (paper, section IV).
#pragma once

#include <cstdint>

#include "core/graph/appearance_graph.h"

namespace mapweld {

// Exact; 0 for a disconnected graph and for fewer than two vertices. Never more than the minimum degree. Weights do
// not count.
//
// Nagamochi, Ono & Ibaraki 1994: a maximum adjacency scan gives every edge a lower bound on the cuts that separate its
// ends; edges whose bound reaches the best cut known so far are contracted, until one vertex is left. O(V E log V) at
// worst, a few scans in practice.
std::uint32_t edge_connectivity(const AppearanceGraph& graph);

}  // namespace mapweld
