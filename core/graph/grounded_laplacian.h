// Solving with a grounded Laplacian: the row and column of one vertex dropped, which leaves a positive definite matrix.
#pragma once

#include <memory>
#include <span>

#include <Eigen/Core>

#include "core/graph/preconditioner.h"

namespace mapweld {

struct LaplacianEdge {
  int u = 0;
  int v = 0;
  double weight = 0;  // > 0
};

// As a preconditioner: L^+ itself.
class GroundedLaplacian : public Preconditioner {
 public:
  explicit GroundedLaplacian(int ground) : ground_(ground) {}
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const final;

 protected:
  // Solves L_g x = b; n - 1 entries each: vertex v stands at v, or at v - 1 past the ground.
  virtual Eigen::VectorXd solve_grounded(const Eigen::VectorXd& b) const = 0;

 private:
  int ground_;
};

// Both for a connected graph of n = `vertices` vertices.

// A sparse LDL^T factor after a minimum degree ordering (AMD); nothing when that takes more than `max_work`
// multiplications, told beforehand from the elimination tree (Davis 2006, section 4.4).
std::unique_ptr<GroundedLaplacian> factor_if_thin(int vertices, int ground, std::span<const LaplacianEdge> edges,
                                                  double max_work);

// Conjugate gradients, preconditioned by an incomplete Cholesky factor, to a relative residual of 1e-13.
std::unique_ptr<GroundedLaplacian> conjugate_gradients(int vertices, int ground, std::span<const LaplacianEdge> edges);

}  // namespace mapweld
