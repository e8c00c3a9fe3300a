// How much an edge between two vertices would do for a graph's algebraic connectivity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/graph/appearance_graph.h"
#include "core/graph/disjoint_sets.h"
#include "core/types.h"

namespace mapweld {

// The largest component of a graph in the coordinates of its lowest eigenvectors, and which component every vertex is
// in; edges that come later are taken in approximately.
//
// With V the lowest eigenvectors and L = V diag(lambda) V^T, an edge (i, j) adds d d^T to the matrix M = V^T L V, where
// d is the difference of rows i and j of V. For lambda_2 alone the gain of a small edge is (v_i - v_j)^2; as soon as
// lambda_2 has grown a little the next eigenvector is the weak place, so the gain here is that of the sum of
// lambda^-r over all of them, which lambda_2 dominates: d^T M^-(r+1) d. Edges that are added (or expected, with a
// weight) change M by a rank-one update, after which candidates over the same gap gain less.
class ConnectivityGain {
 public:
  struct Options {
    int dimensions = 4;
    int power = 3;  // r + 1
  };
  // Costs one spectral_embedding of the largest component; without `embeds` none: then only components are told, and
  // every gain is 0.
  ConnectivityGain(const AppearanceGraph& graph, const Options& options, bool embeds = true);

  // Takes in an edge that the graph has got: joins components. Vertices that come to the embedded component take the
  // place of the vertex that they hang on.
  void add(VertexId u, VertexId v);
  // Takes in an edge with this weight in 0 .. 1 between two embedded vertices.
  void expect(VertexId u, VertexId v, double weight);

  // A vertex that stands for the component of `v`, and how many vertices that has.
  std::uint32_t component(VertexId v) const { return sets_.root(to_index(v)); }
  std::uint32_t component_size(std::uint32_t component) const { return sets_.size_of(component); }
  bool is_embedded(VertexId v) const { return place_[to_index(v)] != kNowhere; }
  // Between two embedded vertices.
  double gain(VertexId u, VertexId v) const;
  // What gain() gave when the graph was embedded, in a tenth of the time.
  double first_gain(VertexId u, VertexId v) const {
    const auto k = static_cast<std::size_t>(coordinates_.cols());
    const float* a = scaled_.data() + k * place_[to_index(u)];
    const float* b = scaled_.data() + k * place_[to_index(v)];
    float sum = 0;
    for (std::size_t i = 0; i < k; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
  }

  // What expect() changes, and nothing else: taken before edges are expected, it takes the expectations back.
  struct Metric {
    Eigen::MatrixXd inverse;  // M^-1
    Eigen::MatrixXd powered;  // M^-power
  };
  const Metric& metric() const { return metric_; }
  void set_metric(Metric metric) { metric_ = std::move(metric); }

 private:
  static constexpr std::uint32_t kNowhere = 0xFFFFFFFF;
  Eigen::VectorXd difference(VertexId u, VertexId v) const;
  void power_up();
  Options options_;
  DisjointSets sets_;
  std::vector<std::vector<std::uint32_t>> hanging_;  // by root, of components that are not embedded: their vertices
  std::vector<std::uint32_t> place_;                 // row of coordinates_
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> coordinates_;
  std::vector<float> scaled_;  // the coordinates, each by lambda^-(power / 2)
  Metric metric_;
};

}  // namespace mapweld
