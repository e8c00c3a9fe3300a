// Which edges a merge will have confirmed in the end that it has not confirmed now.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/merge/certificate/certificate.h"
#include "core/merge/merger.h"
#include "core/merge/spectral/candidate_evidence.h"

namespace mapweld {

// What is thought of a verified edge.
struct EdgeStanding {
  bool confirmed = true;
  double confidence = 1;  // 0 .. 1
};

// Follows one merge. What sets right candidates apart from wrong ones, on photographs and rendered worlds, is how near
// each other their images are already: of candidates whose images have a common neighbour (in the graph, without that
// candidate) nine in ten pass, of those that lie anywhere else in the same component one in a hundred, whatever their
// votes. So candidates fall into classes by hops; in each, log-odds that were fitted once on other merges (by votes,
// rivals, PassModel's chance, how far the merge is) are moved by one offset to what the verdicts of this merge say.
// docs/certificate.md has the figures. A function of the set of verdicts and their standings; one thread.
class Forecast {
 public:
  // All candidates without a verdict and all verified edges without confirmation, each with the chance that it will be
  // confirmed in the end. Nothing while there are votes still to be counted. `standings`: of each edge of the state, in
  // its order; empty: all are confirmed. `confirmed_graph`: inner edges and confirmed inter edges. Always the same
  // merge, or one resumed from its state.
  // Cost: a search of four hops from each image that has candidates, and a few dozen operations a candidate.
  std::optional<std::vector<OpenCandidate>> open(const Merger& merger, const AppearanceGraph& confirmed_graph,
                                                 std::span<const EdgeStanding> standings);

 private:
  void begin(const Merger& merger, const std::vector<Candidate>& open);
  std::uint32_t number_of(VertexId u, VertexId v) const;
  void note_verdicts(const MergeState& state);

  std::vector<std::uint32_t> position_;  // of each merged vertex in the sequence of all members, one after the other
  std::vector<VertexId> vertex_at_;      // by position; gaps between members hold no vertex
  std::vector<double> rivals_;           // by candidate: its votes as a share of the most of either image's, summed
  std::vector<std::uint32_t> stretch_;   // of its own map that each merged vertex lies in
  std::optional<CandidateEvidence> evidence_;
  std::size_t edges_noted_ = 0, rejected_noted_ = 0;
};

}  // namespace mapweld
