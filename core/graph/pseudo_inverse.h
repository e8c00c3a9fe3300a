// The pseudo-inverse of a connected graph's Laplacian as an operator, for Lanczos.
#pragma once

#include <Eigen/Core>

#include "core/graph/grounded_laplacian.h"

namespace mapweld {

// y = L^+ x, in the form that Spectra asks for. `solver` must outlive this.
class PseudoInverse {
 public:
  using Scalar = double;
  PseudoInverse(int vertices, const GroundedLaplacian& solver) : vertices_(vertices), solver_(solver) {}
  Eigen::Index rows() const { return vertices_; }
  Eigen::Index cols() const { return vertices_; }
  void perform_op(const double* x_in, double* y_out) const {
    Eigen::Map<Eigen::VectorXd>(y_out, vertices_) = solver_.solve(Eigen::Map<const Eigen::VectorXd>(x_in, vertices_));
  }

 private:
  int vertices_;
  const GroundedLaplacian& solver_;
};

}  // namespace mapweld
