// A sparse approximate Cholesky factor of a graph Laplacian, as a preconditioner where the exact factor would fill.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/graph/grounded_laplacian.h"
#include "core/graph/preconditioner.h"

namespace mapweld {

// L ~ C D C^T for the Laplacian of a connected graph of n >= 1 vertices. Vertices are eliminated in the order of least
// degree; the clique that an elimination of d neighbours leaves is replaced by a random tree of d - 1 edges whose
// expectation it is (Kyng & Sachdeva 2016; with this ordering Gao, Kyng & Spielman 2023). So the remaining graph never
// gains an edge, the factor keeps to O(m log n) entries, and dead ends, having one or two neighbours, are eliminated
// exactly. In practice the condition
// number of L under it is a small constant, long-range edges or not.
//
// Graphs of high degree want to be made sparse first (core/graph/sparsify.h). Deterministic: the random numbers come
// from a fixed seed. Immutable once made.
class ApproximateCholesky final : public Preconditioner {
 public:
  // Loops are not allowed; parallel edges add up.
  ApproximateCholesky(int vertices, std::span<const LaplacianEdge> edges);

  // About L^+ b, orthogonal to 1: a symmetric positive operator on the complement of 1. n entries.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override;

  std::size_t entries() const { return rows_.size(); }  // of the strictly lower triangle of C

 private:
  std::vector<int> order_;           // vertex by position of elimination
  std::vector<double> pivots_;       // D, by position
  std::vector<std::size_t> starts_;  // by position, n + 1: its column in rows_ and values_
  std::vector<int> rows_;            // positions
  std::vector<double> values_;       // of -C
};

}  // namespace mapweld
