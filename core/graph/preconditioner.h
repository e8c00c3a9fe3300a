// What an iteration for a graph Laplacian L asks of an approximate inverse.
#pragma once

#include <Eigen/Core>

namespace mapweld {

// A symmetric positive operator on the complement of 1, near L^+: exact, approximate, or exact for a graph with a few
// edges less. Immutable once made.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  // n entries in and out; the result is orthogonal to 1.
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& b) const = 0;
};

}  // namespace mapweld
