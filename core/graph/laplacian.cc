#include "core/graph/laplacian.h"

#include <vector>

namespace mapweld {

Eigen::SparseMatrix<double> laplacian(const AppearanceGraph& graph, Weighting weighting) {
  const auto n = static_cast<Eigen::Index>(graph.vertices());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(n) + 2 * graph.edges());
  for (std::uint32_t u = 0; u < graph.vertices(); ++u) {
    double diagonal = 0;
    for (const Neighbour& neighbour : graph.neighbours(VertexId{u})) {
      const double weight = edge_weight(weighting, neighbour.weight);
      diagonal += weight;
      entries.emplace_back(static_cast<int>(u), static_cast<int>(to_index(neighbour.vertex)), -weight);
    }
    entries.emplace_back(static_cast<int>(u), static_cast<int>(u), diagonal);
  }
  Eigen::SparseMatrix<double> result(n, n);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace mapweld
