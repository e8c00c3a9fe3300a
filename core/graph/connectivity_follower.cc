#include "core/graph/connectivity_follower.h"

#include <utility>

#include "core/graph/approximate_cholesky.h"
#include "core/graph/components.h"
#include "core/graph/fiedler_iteration.h"
#include "core/graph/grounded_laplacian.h"
#include "core/graph/sparsify.h"

namespace mapweld {
namespace {

constexpr double kOversampling = 4;

std::vector<LaplacianEdge> edges_on(const AppearanceGraph& graph, const std::vector<VertexId>& vertices) {
  std::vector<int> inside(graph.vertices(), 0);
  for (std::size_t i = 0; i < vertices.size(); ++i) inside[to_index(vertices[i])] = static_cast<int>(i);
  std::vector<LaplacianEdge> edges;
  edges.reserve(graph.edges());
  for (const VertexId u : vertices) {
    for (const Neighbour& n : graph.neighbours(u)) {
      if (u < n.vertex) edges.push_back({inside[to_index(u)], inside[to_index(n.vertex)], 1.0});
    }
  }
  return edges;
}

std::unique_ptr<Preconditioner> make_factor(const AppearanceGraph& graph, const std::vector<VertexId>& vertices,
                                            const std::vector<LaplacianEdge>& edges) {
  std::size_t ground = 0;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    if (graph.degree(vertices[i]) > graph.degree(vertices[ground])) ground = i;
  }
  const int n = static_cast<int>(vertices.size());
  const double max_work = AlgebraicConnectivityOptions{}.max_factor_work_per_vertex * n;
  if (auto exact = factor_if_thin(n, static_cast<int>(ground), edges, max_work)) return exact;
  return std::make_unique<ApproximateCholesky>(n, sparsify(n, edges, kOversampling));
}

}  // namespace

const LargestComponentConnectivity& ConnectivityFollower::refresh(const AppearanceGraph& graph) {
  LargestComponentConnectivity now;
  if (graph.vertices() == 0) {
    factor_.reset();
    return last_ = std::move(now);
  }
  const Components components = connected_components(graph);
  now.components = components.count();
  now.vertices = components.vertices_of(components.largest());
  const int n = static_cast<int>(now.vertices.size());
  if (now.vertices.size() <= AlgebraicConnectivityOptions{}.dense_up_to) {
    factor_.reset();
    now.connectivity = algebraic_connectivity(induced_subgraph(graph, now.vertices));
    return last_ = std::move(now);
  }

  const std::vector<LaplacianEdge> edges = edges_on(graph, now.vertices);
  const auto iterate = [&](int max_iterations) {
    FiedlerIteration found =
        iterate_to_fiedler(n, edges, *factor_, last_.connectivity.fiedler, {.max_iterations = max_iterations});
    if (!found.converged) return false;
    now.connectivity = {found.value, std::move(found.vector), found.residual, EigenSolver::kIteration};
    return true;
  };
  const bool factor_serves = factor_ && now.vertices == last_.vertices;
  if (!factor_serves || !iterate(kStaleSteps)) {
    factor_ = make_factor(graph, now.vertices, edges);
    ++factors_made_;
    if (!iterate(FiedlerIterationOptions{}.max_iterations)) {
      now.connectivity = algebraic_connectivity(induced_subgraph(graph, now.vertices));
    }
  }
  return last_ = std::move(now);
}

}  // namespace mapweld
