// Algebraic connectivity lambda_2(L) and the Fiedler vector (Fiedler 1973; paper, section IV).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/graph/appearance_graph.h"
#include "core/graph/laplacian.h"

namespace mapweld {

struct AlgebraicConnectivityOptions {
  Weighting weighting = Weighting::kUnweighted;
  // A sparse Cholesky factor that would need more multiplications than this for each vertex is not made: in graphs
  // with many long-range edges it fills, and preconditioned iteration is the faster.
  double max_factor_work_per_vertex = 2000;
  std::uint32_t dense_up_to = 24;  // vertices; smaller graphs are left to the dense solver
};

// How the eigenvalue was found.
enum class EigenSolver : std::uint8_t { kNone, kDense, kCholesky, kIteration, kConjugateGradients };

struct AlgebraicConnectivity {
  double value = 0;         // lambda_2; exactly 0 when the graph is disconnected or has fewer than two vertices
  Eigen::VectorXd fiedler;  // n, unit length, orthogonal to 1, the entry of greatest modulus (ties: lowest vertex)
                            // positive; empty when value is 0
  // |L x - value x|: some eigenvalue of L other than that of 1 lies within so much of `value`; and, because `value` is
  // a Rayleigh quotient, lambda_2 <= value but for rounding.
  double residual = 0;
  EigenSolver solver = EigenSolver::kNone;
};

// Three ways. A thin graph (a walk, a grid): one vertex is grounded (its row and column dropped), which leaves a
// positive definite matrix; its sparse LDL^T factor after a minimum degree ordering applies the pseudo-inverse of L,
// whose greatest eigenvalue 1 / lambda_2 Lanczos finds in a few dozen solves. A graph whose factor would fill:
// Davidson's iteration under an approximate factor (core/graph/fiedler_iteration.h), to a residual of 1e-8 of the
// value. Should that not converge: Lanczos again, solving by conjugate gradients.
//
// The value is the Rayleigh quotient of the vector, summed edge by edge, so that it is exact relatively also when tiny:
// to about 1e-12 by the factor, to 1e-8 and mostly 1e-12 by the iteration. Deterministic. Edges of weight 0 count as
// absent under Weighting::kInliers.
AlgebraicConnectivity algebraic_connectivity(const AppearanceGraph& graph,
                                             const AlgebraicConnectivityOptions& options = {});

// Of the largest component (ties: the one with the lowest vertex).
struct LargestComponentConnectivity {
  std::uint32_t components = 0;
  std::vector<VertexId> vertices;      // ascending
  AlgebraicConnectivity connectivity;  // of the graph induced on them; entry i of the Fiedler vector is vertices[i]
};
LargestComponentConnectivity largest_component_connectivity(const AppearanceGraph& graph,
                                                            const AlgebraicConnectivityOptions& options = {});

// Whether adding edges (of weight 1) to the graph that `before` tells of can have changed anything it tells by more
// than `least_change`, relative for lambda_2 (unweighted). The old Fiedler vector x bounds the new value,
//   lambda_2 <= new value <= lambda_2 + sum over the added edges of (x_u - x_v)^2;
// an end outside of the largest component may change the components themselves. True does not say that it did.
bool can_have_changed(const LargestComponentConnectivity& before, std::span<const std::pair<VertexId, VertexId>> added,
                      double least_change = 1e-7);

}  // namespace mapweld
