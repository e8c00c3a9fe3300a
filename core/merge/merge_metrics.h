// What a merge has brought so far: the numbers that a job reports beside algebraic connectivity.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/appearance_graph.h"
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

}  // namespace mapweld
