// How much of what a merge can still reach it has reached: a bound that is never wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Core>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/appearance_graph.h"
#include "core/graph/near_fiedler.h"
#include "core/types.h"

namespace mapweld {

// A candidate without a final verdict.
struct OpenCandidate {
  VertexId u{};
  VertexId v{};
  double chance = 0;  // to be an edge in the end, 0 to 1
  // Candidates of one place are expected to come together or not at all (FinalEstimate). By default its own ends.
  std::optional<std::pair<VertexId, VertexId>> place = std::nullopt;
};

struct CertificateOptions {
  NearFiedlerOptions iteration;  // for graph + R; the value is an upper bound however early it stops
};

// R: the open candidates that are no edges yet. K: the largest component of the graph now (ties: lowest vertex).
struct Certificate {
  // lambda_2(graph on K) / lambda_2((graph + R) on K), never above the exact ratio; exactly 1 when R adds nothing
  // within K (or K is one vertex). lambda_2 on K after any part of R was accepted is at most lambda_2 on K now divided
  // by this.
  double certified_fraction = 1;
  // Vertices outside K that some path through R and edges could still bring in, and those of any other component that
  // could come to outgrow K. While there are any, the fraction speaks of K alone: the final component may be larger, or
  // another one.
  std::uint32_t joinable_vertices = 0;

  std::uint32_t vertices = 0;     // of K
  std::uint64_t open_within = 0;  // candidates of R with both ends in K
  double lower_bound = 0;         // of lambda_2(graph on K)
  double upper_bound = 0;         // of lambda_2((graph + R) on K); 0 when nothing is open within K
  int iterations = 0;
  bool converged = true;  // within max_iterations; the certificate holds without
};

// Pure and deterministic; the order of `open`, chances, repetitions, candidates that are edges already, do not matter.
// Throws std::invalid_argument for a loop or a vertex
// out of range. Costs lambda_2 of the graph and two dozen products with graph + R, no factorisation of that.
Certificate certify(const AppearanceGraph& graph, std::span<const OpenCandidate> open,
                    const CertificateOptions& options = {});

// The same where lambda_2 is known already: `largest` is largest_component_connectivity(graph), unweighted.
Certificate certify(const AppearanceGraph& graph, const LargestComponentConnectivity& largest,
                    std::span<const OpenCandidate> open, const CertificateOptions& options = {});

}  // namespace mapweld
