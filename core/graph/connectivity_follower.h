// lambda_2 of a graph that gains edges, asked for again and again.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/appearance_graph.h"
#include "core/graph/preconditioner.h"

namespace mapweld {

// Keeps the factor that it made last and the last Fiedler vector. Few edges more change the Laplacian by a matrix of
// low rank, so that Davidson's iteration under the old factor, from the old vector, converges in a handful of solves;
// when it takes more than `kStaleSteps`, or the largest component has other vertices, a new factor is made. Values are
// as exact as those of `algebraic_connectivity` (residual 1e-8 of the value), but depend in their last digits on what
// was asked before. Edges may also go. Deterministic. One thread.
class ConnectivityFollower {
 public:
  static constexpr int kStaleSteps = 16;

  // largest_component_connectivity(graph), unweighted.
  const LargestComponentConnectivity& refresh(const AppearanceGraph& graph);
  const LargestComponentConnectivity& last() const { return last_; }
  std::uint64_t factors_made() const { return factors_made_; }

 private:
  LargestComponentConnectivity last_;
  std::unique_ptr<Preconditioner> factor_;  // for last_.vertices
  std::uint64_t factors_made_ = 0;
};

}  // namespace mapweld
