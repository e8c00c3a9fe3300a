#include "core/graph/algebraic_connectivity.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Spectra/SymEigsSolver.h>

#include "core/graph/approximate_cholesky.h"
#include "core/graph/components.h"
#include "core/graph/disjoint_sets.h"
#include "core/graph/fiedler_iteration.h"
#include "core/graph/grounded_laplacian.h"
#include "core/graph/pseudo_inverse.h"
#include "core/graph/sparsify.h"

namespace mapweld {
namespace {

using Vector = Eigen::VectorXd;

constexpr double kOversampling = 4;
constexpr int kMaxIterations = 500;

std::vector<LaplacianEdge> weighted_edges(const AppearanceGraph& graph, Weighting weighting) {
  std::vector<LaplacianEdge> edges;
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

bool is_connected(std::uint32_t vertices, const std::vector<LaplacianEdge>& edges) {
  DisjointSets sets(vertices);
  for (const LaplacianEdge& e : edges) sets.join(static_cast<std::uint32_t>(e.u), static_cast<std::uint32_t>(e.v));
  return vertices > 0 && sets.size_of(0) == vertices;
}

// Fills in value, residual and sign for a vector near the Fiedler vector.
AlgebraicConnectivity measure(Vector x, const std::vector<LaplacianEdge>& edges, EigenSolver solver) {
  x.array() -= x.mean();
  x.normalize();
  Eigen::Index greatest = 0;
  x.cwiseAbs().maxCoeff(&greatest);
  if (x[greatest] < 0) x = -x;
  const RayleighQuotient quotient = rayleigh_quotient(x, edges);
  AlgebraicConnectivity result;
  result.value = quotient.value;
  result.residual = quotient.residual;
  result.fiedler = std::move(x);
  result.solver = solver;
  return result;
}

AlgebraicConnectivity solve_dense(const AppearanceGraph& graph, const std::vector<LaplacianEdge>& edges,
                                  Weighting weighting) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(laplacian(graph, weighting)));
  return measure(solver.eigenvectors().col(1), edges, EigenSolver::kDense);
}

AlgebraicConnectivity solve_by_inverse(int n, const GroundedLaplacian& solver, const std::vector<LaplacianEdge>& edges,
                                       EigenSolver how) {
  PseudoInverse inverse(n, solver);
  for (int basis = 20;; basis *= 2) {
    Spectra::SymEigsSolver<PseudoInverse> lanczos(inverse, 1, std::min(basis, n));
    lanczos.init();
    lanczos.compute(Spectra::SortRule::LargestAlge, 100, 1e-10);
    if (lanczos.info() == Spectra::CompInfo::Successful) {
      const Vector ritz = lanczos.eigenvectors().col(0);
      Vector polished(n);
      inverse.perform_op(ritz.data(), polished.data());
      return measure(std::move(polished), edges, how);
    }
    if (basis >= n) throw std::runtime_error("algebraic connectivity did not converge");
  }
}

std::optional<AlgebraicConnectivity> iterate(int n, const std::vector<LaplacianEdge>& edges) {
  const ApproximateCholesky preconditioner(n, sparsify(n, edges, kOversampling));
  FiedlerIteration found = iterate_to_fiedler(n, edges, preconditioner, {}, {.max_iterations = kMaxIterations});
  if (!found.converged) return std::nullopt;
  return measure(std::move(found.vector), edges, EigenSolver::kIteration);
}

}  // namespace

AlgebraicConnectivity algebraic_connectivity(const AppearanceGraph& graph,
                                             const AlgebraicConnectivityOptions& options) {
  if (graph.vertices() < 2) return {};
  const std::vector<LaplacianEdge> edges = weighted_edges(graph, options.weighting);
  if (!is_connected(graph.vertices(), edges)) return {};
  if (graph.vertices() <= std::max<std::uint32_t>(options.dense_up_to, 3)) {
    return solve_dense(graph, edges, options.weighting);
  }

  const int n = static_cast<int>(graph.vertices());
  int ground = 0;
  for (int v = 1; v < n; ++v) {
    if (graph.degree(VertexId(v)) > graph.degree(VertexId(ground))) ground = v;
  }
  if (const auto factor = factor_if_thin(n, ground, edges, options.max_factor_work_per_vertex * n)) {
    return solve_by_inverse(n, *factor, edges, EigenSolver::kCholesky);
  }
  if (auto result = iterate(n, edges)) return *std::move(result);
  return solve_by_inverse(n, *conjugate_gradients(n, ground, edges), edges, EigenSolver::kConjugateGradients);
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

bool can_have_changed(const LargestComponentConnectivity& before, std::span<const std::pair<VertexId, VertexId>> added,
                      double least_change) {
  const Vector& x = before.connectivity.fiedler;
  const auto entry = [&](VertexId v) -> std::optional<double> {
    const auto found = std::ranges::lower_bound(before.vertices, v);
    if (found == before.vertices.end() || *found != v || x.size() == 0) return std::nullopt;
    return x[found - before.vertices.begin()];
  };
  double growth = 0;
  for (const auto& [u, v] : added) {
    const std::optional<double> at_u = entry(u), at_v = entry(v);
    if (!at_u || !at_v) return true;
    growth += (*at_u - *at_v) * (*at_u - *at_v);
    if (growth > least_change * before.connectivity.value) return true;
  }
  return false;
}

}  // namespace mapweld
