// Dense eigenvalues of small weighted graphs: what the sparse solvers are held against.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Eigenvalues>

#include "core/graph/appearance_graph.h"
#include "core/graph/grounded_laplacian.h"

namespace mapweld::test {

inline Eigen::MatrixXd dense_laplacian(int vertices, std::span<const LaplacianEdge> edges) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(vertices, vertices);
  for (const LaplacianEdge& e : edges) {
    matrix(e.u, e.u) += e.weight;
    matrix(e.v, e.v) += e.weight;
    matrix(e.u, e.v) -= e.weight;
    matrix(e.v, e.u) -= e.weight;
  }
  return matrix;
}

// lambda_2; 0 for one vertex. Exact to about 1e-15 of the greatest degree.
inline double dense_connectivity(int vertices, std::span<const LaplacianEdge> edges) {
  if (vertices < 2) return 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(dense_laplacian(vertices, edges), Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[1];
}

inline std::vector<LaplacianEdge> unit_edges(const AppearanceGraph& graph) {
  std::vector<LaplacianEdge> edges;
  for (const Edge& e : graph.edge_list()) {
    edges.push_back({static_cast<int>(to_index(e.u)), static_cast<int>(to_index(e.v)), 1.0});
  }
  return edges;
}

}  // namespace mapweld::test
