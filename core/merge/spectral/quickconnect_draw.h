// The candidates that QuickConnect would verify first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/merge/spectral/candidate_evidence.h"

namespace mapweld {

// The first `count` open candidates, in order; all when there are no more. First comes the candidate with the most
// votes of each source that has no inter edge yet, by votes; then other candidates of such sources, by votes; then
// those of joined sources by (lower degree of the two ends, votes descending); ties by number. `is_joined`: by vertex,
// whether it has an inter edge; `sources`, `targets`: the vertex of each row, of each column.
std::vector<std::uint32_t> draw_quickconnect(const CandidateEvidence& evidence, const AppearanceGraph& graph,
                                             std::span<const std::uint8_t> is_joined, std::span<const VertexId> sources,
                                             std::span<const VertexId> targets, std::size_t count);

}  // namespace mapweld
