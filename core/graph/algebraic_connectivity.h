// Algebraic connectivity lambda_2(L) and the Fiedler vector (Fiedler 1973; paper, section IV).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/graph/appearance_graph.h"
#include "core/graph/laplacian.h"

namespace mapweld {

struct AlgebraicConnectivityOptions {
  Weighting weighting = Weighting::kUnweighted;
  // A sparse Cholesky factor that would need more multiplications than this is not made; conjugate gradients solve
  // instead (graphs with many long-range edges fill the factor). 2e9 take about a second.
  double max_factor_work = 2e9;
  std::uint32_t dense_up_to = 24;  // vertices; smaller graphs are left to the dense solver
};

// How the eigenvalue was found.
enum class EigenSolver : std::uint8_t { kNone, kDense, kCholesky, kConjugateGradients };

struct AlgebraicConnectivity {
  double value = 0;         // lambda_2; exactly 0 when the graph is disconnected or has fewer than two vertices
  Eigen::VectorXd fiedler;  // n, unit length, orthogonal to 1, the entry of greatest modulus (ties: lowest vertex)
                            // positive; empty when value is 0
  // |L x - value x|: some eigenvalue of L other than that of 1 lies within so much of `value`; and, because `value` is
  // a Rayleigh quotient, lambda_2 <= value but for rounding.
  double residual = 0;
  EigenSolver solver = EigenSolver::kNone;
};

// For a connected graph one vertex is grounded (its row and column dropped), which leaves a positive definite matrix;
// its sparse LDL^T factor after a minimum degree ordering applies the pseudo-inverse of L, whose greatest
// eigenvalue 1 / lambda_2 Lanczos finds in a few dozen solves. The value is then the Rayleigh quotient of the vector,
// summed edge by edge, so that it is exact to about 1e-12 relative also when tiny. Deterministic. Edges of weight 0
// count as absent under Weighting::kInliers.
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

}  // namespace mapweld
