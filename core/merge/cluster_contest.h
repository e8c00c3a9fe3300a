// Which of the clusters of inter-map edges that contradict each other prevail.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/edge_relations.h"
#include "core/types.h"

namespace mapweld {

struct ContestOptions {
  double dropped_beyond = 1.5;     // AliasGuardOptions
  double ambiguous_beyond = 0.5;   // AliasGuardOptions
  double duel_significance = 2.5;  // AliasGuardOptions
};

// A cluster's standing: what all that still stands says for it and against it, and what becomes of it.
struct ClusterStanding {
  Reason reason = Reason::kNone;  // kNone: stands; kUnsupported: dropped; kAmbiguous
  std::uint64_t support = 0;
  std::uint64_t contradiction = 0;
};

// `out`: clusters that do not take part, by number. `bonds` of EdgeRelations, by (of, from).
//
// 1. Clusters that are contradicted by more than dropped_beyond times their support are dropped, all at once; again,
//    without what they said, until none is.
// 2. Duels: two clusters that contradict each other and have vertices in common are compared vertex by vertex: which
// has
//    the more inliers there? One that loses significantly often to a cluster that stands is dropped.
// 3. What is still contradicted by more than ambiguous_beyond times its support is ambiguous.
//
// A function of the sets of edges and clusters, however they are numbered.
std::vector<ClusterStanding> contest(std::span<const WeighedEdge> edges, std::span<const std::uint32_t> cluster_of,
                                     const std::vector<bool>& out, std::span<const ClusterBond> bonds,
                                     const ContestOptions& options);

}  // namespace mapweld
