// How much of what a merge can still reach it has reached: a bound that is never wrong, and an estimate beside it.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/appearance_graph.h"
#include "core/types.h"

namespace mapweld {

// A candidate without a final verdict.
struct OpenCandidate {
  VertexId u{};
  VertexId v{};
  double chance = 0;  // to pass, 0 to 1
};

struct CertificateOptions {
  // The eigenvectors of graph + R are sought until five steps lower the value by no more than this, relatively, or so
  // many steps were made. The value is an upper bound however early it stops.
  double least_progress = 1e-3;
  int max_iterations = 60;
  double oversampling = 3;  // of the preconditioner's graph (core/graph/sparsify.h)
  // Two components count as likely to be joined when one of the candidates between them passes with this chance.
  double likely = 0.5;
};

// R: the open candidates that are no edges yet. K: the largest component of the graph now (ties: lowest vertex).
struct Certificate {
  // lambda_2(graph on K) / lambda_2((graph + R) on K), never above the exact ratio; exactly 1 when R adds nothing
  // within K (or K is one vertex). lambda_2 on K after any part of R was accepted is at most lambda_2 on K now divided
  // by this.
  double certified_fraction = 1;
  // The same with each open candidate weighted by its chance; certified_fraction <= it <= 1. lambda_2 is concave in the
  // weights, so that the weighted value is at least the expected final one (if candidates pass independently with
  // these chances): the estimate errs on the low side.
  double estimated_fraction = 1;
  // Vertices outside K that some path through R and edges could still bring in. While there are any, the fractions
  // speak of K alone: the final component may be larger.
  std::uint32_t joinable_vertices = 0;
  // Those of them that a chain of likely joins would bring in.
  std::uint32_t likely_joinable_vertices = 0;

  std::uint32_t vertices = 0;       // of K
  std::uint64_t open_within = 0;    // candidates of R with both ends in K
  double lower_bound = 0;           // of lambda_2(graph on K)
  double upper_bound = 0;           // of lambda_2((graph + R) on K); 0 when nothing is open within K
  double expected_upper_bound = 0;  // the same, R weighted by chance
  int iterations = 0;               // for both
  bool converged = true;            // both, within max_iterations; the certificate holds without
};

// Pure and deterministic; the order of `open`, repetitions (the greatest chance counts), candidates that are edges
// already, do not matter. Chances outside of [0, 1] are clamped. Throws std::invalid_argument for a loop or a vertex
// out of range. Costs lambda_2 of the graph and two dozen products with graph + R, no factorisation of that.
Certificate certify(const AppearanceGraph& graph, std::span<const OpenCandidate> open,
                    const CertificateOptions& options = {});

// The same where lambda_2 is known already: `largest` is largest_component_connectivity(graph), unweighted.
Certificate certify(const AppearanceGraph& graph, const LargestComponentConnectivity& largest,
                    std::span<const OpenCandidate> open, const CertificateOptions& options = {});

}  // namespace mapweld
