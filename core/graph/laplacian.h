// The graph Laplacian L = D - A (paper, section IV).
#pragma once

#include <cstdint>

#include <Eigen/SparseCore>

#include "core/graph/appearance_graph.h"

namespace mapweld {

// What an edge counts for. The paper's metric is unweighted.
enum class Weighting : std::uint8_t {
  kUnweighted,  // 1
  kInliers,     // the edge's weight, the number of verified inliers
};

constexpr double edge_weight(Weighting weighting, std::uint32_t weight) {
  return weighting == Weighting::kUnweighted ? 1.0 : static_cast<double>(weight);
}

// n x n, both triangles, every diagonal entry stored.
Eigen::SparseMatrix<double> laplacian(const AppearanceGraph& graph, Weighting weighting = Weighting::kUnweighted);

}  // namespace mapweld
