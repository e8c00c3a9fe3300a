// The lowest eigenpairs of a Laplacian: where a graph is weak.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "core/graph/appearance_graph.h"

namespace mapweld {

struct SpectralEmbedding {
  Eigen::VectorXd values;   // ascending, lambda_2 first; k entries
  Eigen::MatrixXd vectors;  // n x k: unit columns, orthogonal to each other and to 1
};

// The k = min(dimensions, n - 1) lowest eigenpairs of L = D - A beside (0, 1), for a connected graph of two vertices or
// more; to a relative accuracy of about 1e-4, which is what choosing by them needs. A graph of up to `dense_up_to`
// vertices is left to the dense solver, others to Lanczos with a grounded factor (algebraic_connectivity.h).
// Deterministic. Throws std::invalid_argument for a disconnected graph.
SpectralEmbedding spectral_embedding(const AppearanceGraph& graph, int dimensions, std::uint32_t dense_up_to = 48);

}  // namespace mapweld
