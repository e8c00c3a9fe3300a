// How much of what a merge will reach it has reached: the best guess, beside the certificate's bound.
#pragma once

#include <span>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/appearance_graph.h"
#include "core/merge/certificate/certificate.h"

namespace mapweld {

struct FinalEstimateOptions {
  int samples = 6;  // ends of the merge that are drawn
  // The drawn ends are too good: where there is one candidate of a place there are more, and elsewhere none. Over real
  // places and rendered worlds a mean fraction f of theirs stood for f^(5/8) of the true end (docs/certificate.md).
  bool is_brought_up = true;
  NearFiedlerOptions iteration;  // of each drawn end
};

struct FinalEstimate {
  // lambda_2 on the largest component now, over that at the end on the same vertices; at most 1.
  double fraction = 1;
  // Vertices of the largest component now, over those at the end; at most 1.
  double vertices_share = 1;
};

// Ends of the merge are drawn: each candidate comes with its chance, those of one place together; the mean over them is
// told. The draws are a function of the candidates alone, the same at each time, so that what is told moves as the
// merge does. Deterministic; the order of `open` and repetitions (the greatest chance counts) do not matter. `largest`:
// largest_component_connectivity(graph), unweighted. Costs a near_fiedler for each sample.
FinalEstimate estimate_final(const AppearanceGraph& graph, const LargestComponentConnectivity& largest,
                             std::span<const OpenCandidate> open, const FinalEstimateOptions& options = {});

}  // namespace mapweld
