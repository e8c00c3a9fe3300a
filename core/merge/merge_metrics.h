// What a merge has brought so far: the numbers that a job reports beside algebraic connectivity.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/appearance_graph.h"
#include "core/graph/connectivity_follower.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"

namespace mapweld {

struct MergeMetrics {
  std::uint32_t components = 0;
  double algebraic_connectivity = 0;   // of the whole: exactly 0 while there are several components
  std::uint32_t largest_vertices = 0;  // of the largest component (ties: lowest vertex)
  double largest_algebraic_connectivity = 0;
  std::vector<std::uint32_t> joined;    // by member: its vertices that have an inter edge
  std::uint32_t independent_joins = 0;  // maximum matching of the inter edges
  friend bool operator==(const MergeMetrics&, const MergeMetrics&) = default;
};

// `graph`: the members' inner edges and the inter edges. Costs one exact eigenvalue; everything else is linear, or
// nearly.
MergeMetrics merge_metrics(const AppearanceGraph& graph, const std::vector<MergeMember>& members,
                           std::span<const MergeEdge> inter_edges);

// The same, asked again and again as inter edges arrive: the eigenvalue is computed only when the edges since it was
// last computed can have changed it by more than 1e-7 of its value (`can_have_changed`), and then from the last
// eigenvector under the last factor (core/graph/connectivity_follower.h); so every value is within 2e-7 of the exact
// one. Counts are exact.
//
// It only looks on. Whatever is not "the same and more edges" (an inter edge gone, inner edges or vertices added)
// starts it anew.
class MergeMetricsFollower {
 public:
  MergeMetrics measure(const AppearanceGraph& graph, const std::vector<MergeMember>& members,
                       std::span<const MergeEdge> inter_edges);

  // Components and eigenvector as of the last computation. Until `measure` computes them anew the largest component is
  // that of the graph given to it last, and lambda_2 there is at least this value: what `certify` needs.
  const LargestComponentConnectivity& largest() const { return connectivity_.last(); }
  std::uint64_t eigenvalues_computed() const { return eigenvalues_computed_; }

 private:
  ConnectivityFollower connectivity_;
  std::vector<std::pair<VertexId, VertexId>> seen_;  // inter edges of the last call
  std::size_t computed_at_ = 0;                      // how many there were at the last refresh of connectivity_
  std::uint32_t vertices_ = 0;
  std::uint64_t inner_edges_ = 0;
  std::uint64_t eigenvalues_computed_ = 0;
};

}  // namespace mapweld
