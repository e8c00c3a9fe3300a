#include "core/graph/fiedler_iteration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Eigenvalues>

namespace mapweld {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr double kRandomShare = 1e-3;
constexpr std::size_t kProgressSteps = 5;
constexpr double kCancelled = 0.05;  // what is left of a vector once the basis is taken out: below this, once more

// Rows of neighbours; products as sums of differences, which lose nothing when x is smooth.
class LaplacianProduct {
 public:
  LaplacianProduct(int vertices, std::span<const LaplacianEdge> edges)
      : starts_(static_cast<std::size_t>(vertices) + 1, 0), entries_(2 * edges.size()) {
    for (const LaplacianEdge& e : edges) {
      ++starts_[e.u + 1];
      ++starts_[e.v + 1];
    }
    for (std::size_t v = 1; v < starts_.size(); ++v) starts_[v] += starts_[v - 1];
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (const LaplacianEdge& e : edges) {
      entries_[next[e.u]++] = {e.weight, e.v};
      entries_[next[e.v]++] = {e.weight, e.u};
    }
  }

  Vector operator()(const Eigen::Ref<const Vector>& x) const {
    Vector y(x.size());
    for (Eigen::Index v = 0; v < x.size(); ++v) {
      const double here = x[v];
      double sum = 0;
      for (std::size_t k = starts_[v]; k < starts_[v + 1]; ++k) {
        sum += entries_[k].weight * (here - x[entries_[k].vertex]);
      }
      y[v] = sum;
    }
    return y;
  }

 private:
  struct Entry {
    double weight;
    int vertex;
  };
  std::vector<std::size_t> starts_;
  std::vector<Entry> entries_;
};

void centre(Vector& x) { x.array() -= x.mean(); }

Vector random_vector(int n) {
  std::mt19937_64 random(1973);
  Vector x(n);
  for (double& entry : x) entry = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
  return x;
}

Vector first_vector(int n, const Preconditioner& preconditioner, const Vector& start) {
  Vector smooth = preconditioner.solve(preconditioner.solve(random_vector(n)));
  smooth.normalize();
  if (start.size() != n) return smooth;
  Vector x = start;
  centre(x);
  const double length = x.norm();
  if (!(length > 0)) return smooth;
  return x / length + kRandomShare * smooth;
}

// The indicator of the vertex of least degree: lambda_2 of a graph with long-range edges is often little below that,
// and its vector hardly more than this one.
Vector loosest_vertex(int n, std::span<const LaplacianEdge> edges) {
  Vector degree = Vector::Zero(n), indicator = Vector::Zero(n);
  for (const LaplacianEdge& e : edges) {
    degree[e.u] += e.weight;
    degree[e.v] += e.weight;
  }
  Eigen::Index least = 0;
  degree.minCoeff(&least);
  indicator[least] = 1;
  return indicator;
}

// An orthonormal basis V of a subspace of the complement of 1, L V, and V^T L V.
class Subspace {
 public:
  Subspace(int n, int capacity, const LaplacianProduct& product)
      : product_(product), basis_(n, capacity), images_(n, capacity), projected_(Matrix::Zero(capacity, capacity)) {}

  int size() const { return size_; }

  // False when t lies in the subspace already but for rounding.
  bool add(Vector t) {
    centre(t);
    double before = t.norm();
    if (!(before > 0)) return false;
    t /= before;
    for (int pass = 0; pass < 4; ++pass) {
      const Vector inside = basis_.leftCols(size_).transpose() * t;
      t.noalias() -= basis_.leftCols(size_) * inside;
      centre(t);
      const double left = t.norm();
      if (left < 1e-10) return false;
      t /= left;
      if (left > kCancelled) break;
    }
    basis_.col(size_) = t;
    images_.col(size_) = product_(basis_.col(size_));
    const Vector column = basis_.leftCols(size_ + 1).transpose() * images_.col(size_);
    projected_.col(size_).head(size_ + 1) = column;
    projected_.row(size_).head(size_ + 1) = column.transpose();
    ++size_;
    return true;
  }

  // A solver of its own for each size: a matrix that is resized and finds no memory is freed twice (Eigen 3.4,
  // DenseStorage::resize).
  void solve() { ritz_.emplace(projected_.topLeftCorner(size_, size_)); }
  double value() const { return ritz_->eigenvalues()[0]; }
  Vector coefficients() const { return ritz_->eigenvectors().col(0); }
  Vector vector() const { return basis_.leftCols(size_) * coefficients(); }
  Vector image() const { return images_.leftCols(size_) * coefficients(); }

  // Keeps the lowest Ritz vectors and the best vector of the step before, given by its coefficients.
  void restart(int kept, const Vector& previous) {
    Matrix chosen(size_, kept + 1);
    chosen.leftCols(kept) = ritz_->eigenvectors().leftCols(kept);
    Vector last = Vector::Zero(size_);
    last.head(previous.size()) = previous;
    for (int pass = 0; pass < 2; ++pass) {
      last -= chosen.leftCols(kept) * (chosen.leftCols(kept).transpose() * last);
    }
    const double length = last.norm();
    const int count = length > 1e-8 ? kept + 1 : kept;
    if (count > kept) chosen.col(kept) = last / length;
    const Matrix basis = basis_.leftCols(size_) * chosen.leftCols(count);
    const Matrix images = images_.leftCols(size_) * chosen.leftCols(count);
    size_ = count;
    basis_.leftCols(size_) = basis;
    images_.leftCols(size_) = images;
    projected_.topLeftCorner(size_, size_) = basis.transpose() * images;
    solve();
  }

 private:
  const LaplacianProduct& product_;
  Matrix basis_, images_, projected_;
  int size_ = 0;
  std::optional<Eigen::SelfAdjointEigenSolver<Matrix>> ritz_;  // none before the first solve()
};

}  // namespace

RayleighQuotient rayleigh_quotient(const Vector& x, std::span<const LaplacianEdge> edges) {
  const double mean = x.mean();
  double numerator = 0;
  Vector image = Vector::Zero(x.size());
  for (const LaplacianEdge& e : edges) {
    const double difference = x[e.u] - x[e.v];
    const double flow = e.weight * difference;
    numerator += flow * difference;
    image[e.u] += flow;
    image[e.v] -= flow;
  }
  const double square = (x.array() - mean).square().sum();
  RayleighQuotient result;
  result.value = numerator / square;
  result.residual = std::sqrt((image.array() - result.value * (x.array() - mean)).square().sum() / square);
  return result;
}

FiedlerIteration iterate_to_fiedler(int vertices, std::span<const LaplacianEdge> edges,
                                    const Preconditioner& preconditioner, const Vector& start,
                                    const FiedlerIterationOptions& options) {
  const LaplacianProduct product(vertices, edges);
  const int capacity = std::min(std::max(options.basis, 4), vertices - 1);
  const int kept = std::clamp(options.kept, 1, std::max(capacity - 2, 1));
  Subspace subspace(vertices, capacity, product);
  FiedlerIteration result;
  subspace.add(first_vector(vertices, preconditioner, start));
  if (capacity > 2) subspace.add(preconditioner.solve(loosest_vertex(vertices, edges)));
  Vector previous;
  std::vector<double> values;
  while (true) {
    ++result.iterations;
    subspace.solve();
    result.vector = subspace.vector();
    Vector defect = subspace.image() - subspace.value() * result.vector;
    const double defect_size = defect.norm();
    values.push_back(subspace.value());
    const bool is_slow =
        values.size() > kProgressSteps && defect_size < subspace.value() / 3 &&
        values[values.size() - 1 - kProgressSteps] - values.back() <= options.least_progress * values.back();
    result.converged = defect_size <= options.tolerance * subspace.value() || (options.least_progress > 0 && is_slow);
    if (result.converged || result.iterations >= options.max_iterations) break;
    if (subspace.size() == capacity) {
      if (capacity == vertices - 1) {  // the whole space: as exact as can be
        result.converged = true;
        break;
      }
      subspace.restart(kept, previous);
    }
    previous = subspace.coefficients();
    if (!subspace.add(preconditioner.solve(defect))) break;
  }
  centre(result.vector);
  result.vector.normalize();
  Eigen::Index greatest = 0;
  result.vector.cwiseAbs().maxCoeff(&greatest);
  if (result.vector[greatest] < 0) result.vector = -result.vector;
  const RayleighQuotient quotient = rayleigh_quotient(result.vector, edges);
  result.value = quotient.value;
  result.residual = quotient.residual;
  return result;
}

}  // namespace mapweld
