// The verdicts on all candidates of a pair of maps, those that a threshold would refuse included.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/types.h"

namespace mapweld::server::evaluation {

struct CandidateVerdict {
  std::uint32_t a = 0;  // vertex of the first map, its own number
  std::uint32_t b = 0;  // vertex of the second
  std::uint32_t votes = 0;
  int inliers = 0;
  double log10_false_alarms = 0;
  bool plausible = false;  // passes everything but the two thresholds, min_inliers and max_false_alarms
};

// Whether the verifier with these thresholds accepts.
bool accepts(const CandidateVerdict& verdict, const VerifierOptions& thresholds);

// Verifies every pair with min_votes or more. `input.verifier` must be the most lenient one (kLenient), so that only
// `accepts` draws the line. Ascending by (a, b), whatever the number of threads. `progress` is told how many are done,
// from any thread, one at a time.
std::vector<CandidateVerdict> verify_candidates(const MergeInput& input, int threads,
                                                const std::function<void(std::uint64_t)>& progress = {});

inline constexpr VerifierOptions kLenient{.min_inliers = kFewestInliers, .max_false_alarms = 1e300};

}  // namespace mapweld::server::evaluation
