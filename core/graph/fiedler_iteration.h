// The Fiedler pair of a weighted graph without an exact factor: preconditioned iteration in a small subspace.
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/graph/grounded_laplacian.h"
#include "core/graph/preconditioner.h"

namespace mapweld {

struct RayleighQuotient {
  double value = 0;     // of x less its mean: never below lambda_2 but for rounding (1e-13 relative)
  double residual = 0;  // |L x - value x| / |x|: some eigenvalue of L lies within so much of `value`
};

// Summed edge by edge, so that a tiny value is exact relatively. `x` must not be constant.
RayleighQuotient rayleigh_quotient(const Eigen::VectorXd& x, std::span<const LaplacianEdge> edges);

struct FiedlerIterationOptions {
  double tolerance = 1e-8;  // of the residual, relative to the value
  // Also stop when five steps lowered the value by no more than this, relatively, and the residual is below a third of
  // the value; 0: never.
  double least_progress = 0;
  int max_iterations = 200;
  int basis = 12;  // vectors kept, each twice
  int kept = 4;    // Ritz vectors that survive when the basis is full
};

struct FiedlerIteration {
  double value = 0;        // the Rayleigh quotient of `vector`: an upper bound of lambda_2 however early it stopped
  double residual = 0;     // |L x - value x|
  Eigen::VectorXd vector;  // n, unit length, orthogonal to 1, the entry of greatest modulus positive
  int iterations = 0;      // products with L
  bool converged = false;  // it stopped by `tolerance` or `least_progress`, not by `max_iterations`
};

// Generalised Davidson with thick restart (Stathopoulos, Saad & Wu 1998) on the complement of 1 for the Laplacian of a
// connected graph of n >= 2 vertices: each step adds the preconditioned residual to the subspace, and the best vector
// of the subspace is taken. Deterministic.
//
// `start` is a vector near the Fiedler vector, for example that of a graph with some edges less; empty: none known. A
// thousandth of a smoothed random vector is added to it, lest a start that is another eigenvector is taken for the
// answer.
FiedlerIteration iterate_to_fiedler(int vertices, std::span<const LaplacianEdge> edges,
                                    const Preconditioner& preconditioner, const Eigen::VectorXd& start = {},
                                    const FiedlerIterationOptions& options = {});

}  // namespace mapweld
