#include "core/graph/algebraic_connectivity.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <Spectra/SymEigsSolver.h>

#include "core/graph/components.h"

namespace mapweld {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

struct WeightedEdge {
  int u;
  int v;
  double weight;
};

std::vector<WeightedEdge> weighted_edges(const AppearanceGraph& graph, Weighting weighting) {
  std::vector<WeightedEdge> edges;
  edges.reserve(graph.edges());
  for (std::uint32_t u = 0; u < graph.vertices(); ++u) {
    for (const Neighbour& n : graph.neighbours(VertexId{u})) {
      const double weight = edge_weight(weighting, n.weight);
      if (u < to_index(n.vertex) && weight > 0) {
        edges.push_back({static_cast<int>(u), static_cast<int>(to_index(n.vertex)), weight});
      }
    }
  }
  return edges;
}

bool is_connected(std::uint32_t vertices, const std::vector<WeightedEdge>& edges) {
  std::vector<int> parent(vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) parent[v] = static_cast<int>(v);
  const auto root = [&parent](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::uint32_t components = vertices;
  for (const WeightedEdge& e : edges) {
    const int a = root(e.u), b = root(e.v);
    if (a == b) continue;
    parent[a] = b;
    --components;
  }
  return components == 1;
}

// Applies the inverse of the grounded Laplacian. Vertex v stands at v, or at v - 1 past the ground.
class GroundedSolver {
 public:
  virtual ~GroundedSolver() = default;
  virtual Vector solve(const Vector& b) const = 0;
  virtual EigenSolver kind() const = 0;
};

class CholeskySolver final : public GroundedSolver {
 public:
  using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;
  CholeskySolver(const Matrix& permuted, Permutation permutation) : permutation_(std::move(permutation)) {
    factor_.compute(permuted);
    if (factor_.info() != Eigen::Success) throw std::runtime_error("the grounded Laplacian did not factor");
  }
  Vector solve(const Vector& b) const override {
    const Vector permuted = permutation_ * b;
    const Vector x = factor_.solve(permuted);
    return permutation_.transpose() * x;
  }
  EigenSolver kind() const override { return EigenSolver::kCholesky; }

 private:
  Permutation permutation_;
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
};

class ConjugateGradientSolver final : public GroundedSolver {
 public:
  explicit ConjugateGradientSolver(Matrix matrix) : matrix_(std::move(matrix)) {
    gradients_.setTolerance(1e-13);
    gradients_.setMaxIterations(20 * static_cast<int>(std::sqrt(static_cast<double>(matrix_.rows()))) + 2000);
    gradients_.compute(matrix_);
  }
  Vector solve(const Vector& b) const override { return gradients_.solve(b); }
  EigenSolver kind() const override { return EigenSolver::kConjugateGradients; }

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

std::unique_ptr<GroundedSolver> make_grounded_solver(int vertices, int ground, const std::vector<WeightedEdge>& edges,
                                                     double max_factor_work) {
  const int n = vertices - 1;
  const auto position = [ground](int v) { return v < ground ? v : v - 1; };
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * edges.size());
  for (const WeightedEdge& e : edges) {
    if (e.u != ground) entries.emplace_back(position(e.u), position(e.u), e.weight);
    if (e.v != ground) entries.emplace_back(position(e.v), position(e.v), e.weight);
    if (e.u != ground && e.v != ground) {
      entries.emplace_back(position(e.u), position(e.v), -e.weight);
      entries.emplace_back(position(e.v), position(e.u), -e.weight);
    }
  }
  Matrix grounded(n, n);
  grounded.setFromTriplets(entries.begin(), entries.end());

  CholeskySolver::Permutation inverse;
  Eigen::AMDOrdering<int>()(grounded, inverse);
  const CholeskySolver::Permutation permutation = inverse.inverse();
  Matrix permuted(n, n);
  permuted = grounded.twistedBy(permutation);
  if (factor_is_affordable(permuted, max_factor_work)) return std::make_unique<CholeskySolver>(permuted, permutation);
  return std::make_unique<ConjugateGradientSolver>(std::move(grounded));
}

// y = L^+ x, in the form that Spectra asks for.
class PseudoInverse {
 public:
  using Scalar = double;
  PseudoInverse(int vertices, int ground, const GroundedSolver& solver)
      : vertices_(vertices), ground_(ground), solver_(solver) {}
  Eigen::Index rows() const { return vertices_; }
  Eigen::Index cols() const { return vertices_; }
  void perform_op(const double* x_in, double* y_out) const {
    const Eigen::Map<const Vector> x(x_in, vertices_);
    Eigen::Map<Vector> y(y_out, vertices_);
    const double mean = x.mean();
    const Eigen::Index after = vertices_ - ground_ - 1;
    Vector b(vertices_ - 1);
    b.head(ground_) = x.head(ground_).array() - mean;
    b.tail(after) = x.tail(after).array() - mean;
    const Vector z = solver_.solve(b);
    y.head(ground_) = z.head(ground_);
    y[ground_] = 0;
    y.tail(after) = z.tail(after);
    y.array() -= y.mean();
  }

 private:
  int vertices_;
  int ground_;
  const GroundedSolver& solver_;
};

// Fills in value, residual and sign for a vector near the Fiedler vector.
AlgebraicConnectivity measure(Vector x, const std::vector<WeightedEdge>& edges, EigenSolver solver) {
  x.array() -= x.mean();
  x.normalize();
  Eigen::Index greatest = 0;
  x.cwiseAbs().maxCoeff(&greatest);
  if (x[greatest] < 0) x = -x;
  AlgebraicConnectivity result;
  double numerator = 0;
  Vector image = Vector::Zero(x.size());
  for (const WeightedEdge& e : edges) {
    const double difference = x[e.u] - x[e.v];
    numerator += e.weight * difference * difference;
    image[e.u] += e.weight * difference;
    image[e.v] -= e.weight * difference;
  }
  result.value = numerator / x.squaredNorm();
  result.residual = (image - result.value * x).norm();
  result.fiedler = std::move(x);
  result.solver = solver;
  return result;
}

AlgebraicConnectivity solve_dense(const AppearanceGraph& graph, const std::vector<WeightedEdge>& edges,
                                  Weighting weighting) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(laplacian(graph, weighting)));
  return measure(solver.eigenvectors().col(1), edges, EigenSolver::kDense);
}

}  // namespace

AlgebraicConnectivity algebraic_connectivity(const AppearanceGraph& graph,
                                             const AlgebraicConnectivityOptions& options) {
  if (graph.vertices() < 2) return {};
  const std::vector<WeightedEdge> edges = weighted_edges(graph, options.weighting);
  if (!is_connected(graph.vertices(), edges)) return {};
  if (graph.vertices() <= std::max<std::uint32_t>(options.dense_up_to, 3)) {
    return solve_dense(graph, edges, options.weighting);
  }

  const int n = static_cast<int>(graph.vertices());
  int ground = 0;
  for (int v = 1; v < n; ++v) {
    if (graph.degree(VertexId(v)) > graph.degree(VertexId(ground))) ground = v;
  }
  const std::unique_ptr<GroundedSolver> solver = make_grounded_solver(n, ground, edges, options.max_factor_work);
  PseudoInverse inverse(n, ground, *solver);
  for (int basis = 20;; basis *= 2) {
    Spectra::SymEigsSolver<PseudoInverse> lanczos(inverse, 1, std::min(basis, n));
    lanczos.init();
    lanczos.compute(Spectra::SortRule::LargestAlge, 100, 1e-10);
    if (lanczos.info() == Spectra::CompInfo::Successful) {
      const Vector ritz = lanczos.eigenvectors().col(0);
      Vector polished(n);
      inverse.perform_op(ritz.data(), polished.data());
      return measure(std::move(polished), edges, solver->kind());
    }
    if (basis >= n) throw std::runtime_error("algebraic connectivity did not converge");
  }
}

LargestComponentConnectivity largest_component_connectivity(const AppearanceGraph& graph,
                                                            const AlgebraicConnectivityOptions& options) {
  LargestComponentConnectivity result;
  if (graph.vertices() == 0) return result;
  const Components components = connected_components(graph);
  result.components = components.count();
  result.vertices = components.vertices_of(components.largest());
  result.connectivity = result.components == 1
                            ? algebraic_connectivity(graph, options)
                            : algebraic_connectivity(induced_subgraph(graph, result.vertices), options);
  return result;
}

}  // namespace mapweld
