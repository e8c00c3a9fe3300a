// What votes alone tell about each candidate of a merge.
#pragma once

#include <span>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/merge/spectral/candidate_evidence.h"

namespace mapweld {

// Log-odds that each candidate will be a confirmed edge, before anything is verified: by its own votes, and by the
// votes around it, between the images that its two images are linked to in their own maps (and the two themselves). Two
// views of one place have neighbours that share views too; two that only look alike seldom have. Weights fitted once
// (docs/spectral.md).
// `inner`: inner edges, over all merged vertices. `sources`, `targets`: the vertex of each row, of each column, which
// may have several (PairBlocks). `cells`: the candidates, ascending by (row, column), each once. Multiples of 1/1024,
// so that sums of them are exact. The same on every processor. Costs some operations a candidate and link of its
// images.
std::vector<float> vote_odds(const AppearanceGraph& inner, std::span<const VertexId> sources,
                             std::span<const VertexId> targets, std::span<const CandidateEvidence::Cell> cells);

}  // namespace mapweld
