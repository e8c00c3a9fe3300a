// What no choice of so many edges can surpass.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "core/graph/appearance_graph.h"
#include "core/types.h"

namespace mapweld {

struct ChoiceBoundOptions {
  int iterations = 60;
  // Numbers of edges, the best first, of which the first `count` are a good choice: the iteration begins near them, and
  // comes nearer in the same time. Fewer, or none: it begins with equal weights.
  std::span<const std::uint32_t> good = {};
};

// An upper bound of lambda_2 of `graph` with any `count` of `edges`: MAC's relaxation (Doherty, Papalia, Huang, Rosen,
// Englot & Leonard: MAC: Graph sparsification by maximizing algebraic connectivity, 2024). In place of choosing, every
// edge e gets a weight w_e in 0 .. 1, `count` in all; lambda_2(w) is concave, and Frank & Wolfe's iteration climbs it
// along the supergradient (x_i - x_j)^2 of the Fiedler vector x. What is told is the dual: for any unit vector x
// orthogonal to 1
//   lambda_2(w) <= x^T L(w) x <= x^T L x + the sum of the `count` greatest (x_i - x_j)^2,
// the least of it over the iterates, and over their running mean, which is sound as well (a mean of such bounds, taken
// before the choice) and the nearer where at the optimum several eigenvalues are equal. So the bound holds however
// early the iteration stops and however rough its vectors are; how near it comes is another matter. Fewer edges than
// join the graph's components: 0.
//
// `graph` with all edges must be connected and simple (no edge twice); lambda_2 of that from `count` = their number on.
// Throws std::invalid_argument otherwise. Deterministic. One near_fiedler an iteration.
double choice_bound(const AppearanceGraph& graph, std::span<const std::pair<VertexId, VertexId>> edges,
                    std::uint32_t count, const ChoiceBoundOptions& options = {});

}  // namespace mapweld
