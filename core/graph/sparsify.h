// A sparser graph with about the same Laplacian, for preconditioners.
#pragma once

#include <span>
#include <vector>

#include "core/graph/grounded_laplacian.h"

namespace mapweld {

// Keeps a spanning forest (the first edges that make one) and of the others each with probability
//   min(1, oversampling * w (1 / D_u + 1 / D_v)),  D the weighted degrees,
// its weight divided by the probability, so that the expectation of the Laplacian is the Laplacian: sampling by
// effective resistances (Spielman & Srivastava 2011) with their lower bound by degrees in their place, which is near
// them in graphs with many long-range edges; the forest keeps the bridges where it is not. At most about
// (oversampling + 1) n edges are left. Deterministic: the random numbers come from a fixed seed, in the order of edges.
std::vector<LaplacianEdge> sparsify(int vertices, std::span<const LaplacianEdge> edges, double oversampling);

}  // namespace mapweld
