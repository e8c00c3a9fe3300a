#include "core/graph/grounded_laplacian.h"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace mapweld {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

class CholeskySolver final : public GroundedLaplacian {
 public:
  using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;
  CholeskySolver(int ground, const Matrix& permuted, Permutation permutation)
      : GroundedLaplacian(ground), permutation_(std::move(permutation)) {
    factor_.compute(permuted);
    if (factor_.info() != Eigen::Success) throw std::runtime_error("the grounded Laplacian did not factor");
  }
  Eigen::VectorXd solve_grounded(const Eigen::VectorXd& b) const override {
    const Eigen::VectorXd permuted = permutation_ * b;
    const Eigen::VectorXd x = factor_.solve(permuted);
    return permutation_.transpose() * x;
  }

 private:
  Permutation permutation_;
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
};

class ConjugateGradientSolver final : public GroundedLaplacian {
 public:
  ConjugateGradientSolver(int ground, Matrix matrix) : GroundedLaplacian(ground), matrix_(std::move(matrix)) {
    gradients_.setTolerance(1e-13);
    gradients_.setMaxIterations(20 * static_cast<int>(std::sqrt(static_cast<double>(matrix_.rows()))) + 2000);
    gradients_.compute(matrix_);
  }
  Eigen::VectorXd solve_grounded(const Eigen::VectorXd& b) const override { return gradients_.solve(b); }

 private:
  Matrix matrix_;
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Eigen::IncompleteCholesky<double>> gradients_;
};

// Whether the Cholesky factor of a symmetric matrix (both triangles given) takes at most `max_work` multiplications:
// the elimination tree gives the column counts without the factor (Davis 2006, section 4.4).
bool factor_is_affordable(const Matrix& matrix, double max_work) {
  const int n = static_cast<int>(matrix.rows());
  std::vector<int> parent(n, -1), seen_by(n, -1);
  std::vector<double> count(n, 0);
  double entries = 0;
  for (int k = 0; k < n; ++k) {
    seen_by[k] = k;
    for (Matrix::InnerIterator it(matrix, k); it; ++it) {
      for (int i = static_cast<int>(it.row()); i < k && seen_by[i] != k; i = parent[i]) {
        if (parent[i] == -1) parent[i] = k;
        seen_by[i] = k;
        count[i] += 1;
        entries += 1;
      }
    }
    if (entries * entries > max_work * n) return false;  // sum of squares >= square of the sum / n
  }
  double work = 0;
  for (const double c : count) work += c * c;
  return work <= max_work;
}

Matrix grounded_matrix(int vertices, int ground, std::span<const LaplacianEdge> edges) {
  const int n = vertices - 1;
  const auto position = [ground](int v) { return v < ground ? v : v - 1; };
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * edges.size());
  for (const LaplacianEdge& e : edges) {
    if (e.u != ground) entries.emplace_back(position(e.u), position(e.u), e.weight);
    if (e.v != ground) entries.emplace_back(position(e.v), position(e.v), e.weight);
    if (e.u != ground && e.v != ground) {
      entries.emplace_back(position(e.u), position(e.v), -e.weight);
      entries.emplace_back(position(e.v), position(e.u), -e.weight);
    }
  }
  Matrix grounded(n, n);
  grounded.setFromTriplets(entries.begin(), entries.end());
  return grounded;
}

}  // namespace

Eigen::VectorXd GroundedLaplacian::solve(const Eigen::VectorXd& b) const {
  const double mean = b.mean();
  const Eigen::Index after = b.size() - ground_ - 1;
  Eigen::VectorXd grounded(b.size() - 1);
  grounded.head(ground_) = b.head(ground_).array() - mean;
  grounded.tail(after) = b.tail(after).array() - mean;
  const Eigen::VectorXd z = solve_grounded(grounded);
  Eigen::VectorXd x(b.size());
  x.head(ground_) = z.head(ground_);
  x[ground_] = 0;
  x.tail(after) = z.tail(after);
  x.array() -= x.mean();
  return x;
}

std::unique_ptr<GroundedLaplacian> factor_if_thin(int vertices, int ground, std::span<const LaplacianEdge> edges,
                                                  double max_work) {
  const Matrix grounded = grounded_matrix(vertices, ground, edges);
  CholeskySolver::Permutation inverse;
  Eigen::AMDOrdering<int>()(grounded, inverse);
  const CholeskySolver::Permutation permutation = inverse.inverse();
  Matrix permuted(vertices - 1, vertices - 1);
  permuted = grounded.twistedBy(permutation);
  if (!factor_is_affordable(permuted, max_work)) return nullptr;
  return std::make_unique<CholeskySolver>(ground, permuted, permutation);
}

std::unique_ptr<GroundedLaplacian> conjugate_gradients(int vertices, int ground, std::span<const LaplacianEdge> edges) {
  return std::make_unique<ConjugateGradientSolver>(ground, grounded_matrix(vertices, ground, edges));
}

}  // namespace mapweld
