// lambda_2 from above, near enough to compare graphs by, where exact ones would cost ten times as much.
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/graph/fiedler_iteration.h"

namespace mapweld {

struct NearFiedlerOptions {
  // Stops when five steps lower the value by no more than this, relatively, or after so many steps.
  double least_progress = 1e-3;
  int max_iterations = 60;
  double oversampling = 3;  // of the preconditioner's graph (core/graph/sparsify.h)
};

// The Fiedler vector of a connected graph of n >= 2 vertices, and an upper bound of lambda_2 that is mostly within
// 0.1 % of it (certificate_test). `start`: a vector near it, or empty. Deterministic. Two dozen products with the
// Laplacian, no factor of it.
FiedlerIteration near_fiedler(int vertices, std::span<const LaplacianEdge> edges, const Eigen::VectorXd& start,
                              const NearFiedlerOptions& options = {});

}  // namespace mapweld
