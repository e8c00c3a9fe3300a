// Which open candidates keep a merge's certificate low.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/types.h"

namespace mapweld {

// With w the Fiedler vector of the graph and all open candidates, the certificate's upper bound (certificate.h) falls
// by (w_u - w_v)^2, to first order, when candidate (u, v) is refused; when it is accepted the lower bound grows. And
// while a candidate could still join somebody to the largest component there is no stopping by it at all.
struct CertificateOrder {
  std::vector<std::uint32_t> within;   // both ends in the largest component: by (w_u - w_v)^2, greatest first
  std::vector<std::uint32_t> joining;  // the others, in the order given
};

// At most `count` of each; indices into `open`, the ends of the open candidates. Ties by index. Costs lambda_2 of the
// largest component and a near_fiedler with all candidates. Deterministic.
CertificateOrder certificate_order(const AppearanceGraph& graph, std::span<const std::pair<VertexId, VertexId>> open,
                                   std::size_t count);

}  // namespace mapweld
