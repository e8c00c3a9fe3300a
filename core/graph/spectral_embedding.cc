#include "core/graph/spectral_embedding.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Spectra/SymEigsSolver.h>

#include "core/graph/components.h"
#include "core/graph/grounded_laplacian.h"
#include "core/graph/laplacian.h"
#include "core/graph/pseudo_inverse.h"

namespace mapweld {
namespace {

constexpr double kMaxFactorWork = 2e9;

SpectralEmbedding solve_dense(const AppearanceGraph& graph, int k) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(laplacian(graph)));
  return {solver.eigenvalues().segment(1, k), solver.eigenvectors().middleCols(1, k)};
}

}  // namespace

SpectralEmbedding spectral_embedding(const AppearanceGraph& graph, int dimensions, std::uint32_t dense_up_to) {
  const int n = static_cast<int>(graph.vertices());
  if (n < 2 || connected_components(graph).count() != 1) {
    throw std::invalid_argument("a spectral embedding is of a connected graph");
  }
  const int k = std::min(dimensions, n - 1);
  const int least_basis = 2 * k + 12;
  if (graph.vertices() <= dense_up_to || n <= least_basis + 1) return solve_dense(graph, k);

  std::vector<LaplacianEdge> edges;
  edges.reserve(graph.edges());
  int ground = 0;
  for (int u = 0; u < n; ++u) {
    if (graph.degree(VertexId(u)) > graph.degree(VertexId(ground))) ground = u;
    for (const Neighbour& neighbour : graph.neighbours(VertexId(u))) {
      const int v = static_cast<int>(to_index(neighbour.vertex));
      if (u < v) edges.push_back({u, v, 1.0});
    }
  }
  std::unique_ptr<GroundedLaplacian> solver = factor_if_thin(n, ground, edges, kMaxFactorWork);
  if (!solver) solver = conjugate_gradients(n, ground, edges);
  PseudoInverse inverse(n, *solver);
  for (int basis = least_basis;; basis *= 2) {
    Spectra::SymEigsSolver<PseudoInverse> lanczos(inverse, k, std::min(basis, n));
    lanczos.init();
    lanczos.compute(Spectra::SortRule::LargestAlge, 100, 1e-4);
    if (lanczos.info() == Spectra::CompInfo::Successful) {
      return {lanczos.eigenvalues().cwiseInverse(), lanczos.eigenvectors()};
    }
    if (basis >= n) return solve_dense(graph, k);
  }
}

}  // namespace mapweld
