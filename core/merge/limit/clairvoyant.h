// The order in which one would take edges who knew beforehand which candidates pass.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/types.h"

namespace mapweld {

struct ClairvoyantOptions {
  double goal = std::numeric_limits<double>::infinity();  // stops when lambda_2 of the graph reaches it,
  std::uint32_t max_picks = 5000;                         // or after so many
};

// One more edge taken.
struct ClairvoyantPick {
  std::uint32_t edge = 0;   // its number in `edges`
  double connectivity = 0;  // lambda_2 of the graph with it, as a ConnectivityFollower has it; 0 while in pieces
};

// Greedy, edge by edge. While the graph is in pieces: the edge that lets the largest component grow most, of several
// the one with the greatest (x_i - x_j)^2, x the Fiedler vector of the graph with all edges (where that is connected).
// From then on: the edge with the greatest (v_i - v_j)^2, v the Fiedler vector of the graph so far, solved anew after
// each pick. Ties go to the lowest number. (Sums over several eigenvectors take about as many edges, or more.)
//
// Near the fewest edges that there are for a value, and no bound (core/merge/limit/choice_bound.h has one): nothing is
// taken back. Edges that the graph has already, and loops, are never taken. Deterministic. Throws std::invalid_argument
// for an end out of range.
std::vector<ClairvoyantPick> clairvoyant_order(const AppearanceGraph& graph,
                                               std::span<const std::pair<VertexId, VertexId>> edges,
                                               const ClairvoyantOptions& options = {});

}  // namespace mapweld
