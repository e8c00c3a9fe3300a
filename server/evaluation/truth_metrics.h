// Precision, recall and errors against a known truth. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/evaluation/candidate_verdicts.h"
#include "server/evaluation/evaluation.h"
#include "server/evaluation/truth.h"

namespace mapweld::server::evaluation {

// Everything with a score of `threshold` or more accepted.
struct PrecisionRecall {
  double threshold = 0;
  std::uint64_t accepted = 0;
  std::uint64_t right = 0;  // of them
  double precision = 0;
  double recall = 0;  // of all right pairs, those that were no candidates included
};

struct ScoredPair {
  double score = 0;
  bool right = false;
};

// One point for each distinct score, descending. `right_pairs`: how many there are to be found.
std::vector<PrecisionRecall> precision_recall(std::vector<ScoredPair> pairs, std::uint64_t right_pairs);

// The point with the greatest recall among those that accept nothing wrong; nullopt when the best score is wrong.
std::optional<PrecisionRecall> at_full_precision(std::span<const PrecisionRecall> points);

// The thresholds of greatest recall whose precision is at least `min_precision`, from a grid: min_inliers 8 .. 64,
// max_false_alarms 10^0 .. 10^-40. Of several the mildest max_false_alarms, then the lowest min_inliers. nullopt when
// there are none.
struct SuggestedThresholds {
  int min_inliers = 0;
  int log10_max_false_alarms = 0;
  PrecisionRecall result;  // `threshold` unused
};
std::optional<SuggestedThresholds> suggest_thresholds(std::span<const CandidateVerdict> verdicts, const Truth& truth,
                                                      double min_precision);

// Localizing each image of the second map whose place the first has: is a right image among the first k?
struct RecallAtK {
  std::uint32_t k = 0;
  double by_votes = 0;     // candidates by votes
  double by_verified = 0;  // accepted candidates by inliers
};
std::vector<RecallAtK> recall_at_k(std::span<const CandidateVerdict> verdicts, const Truth& truth,
                                   std::uint32_t second_vertices, const VerifierOptions& thresholds,
                                   std::span<const std::uint32_t> ks);

// An edge of the merged numbering as a pair of the two maps' own vertices. The first map has `first_vertices`.
struct MapPair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};
MapPair pair_of(const RecordedEdge& edge, std::uint32_t first_vertices);

// How many of the first 0, 1, 2, ... edges are not right, or not even listed: edges.size() + 1 counts.
enum class Error : std::uint8_t { kNotRight, kNotListed };
std::vector<std::uint64_t> wrong_edges(std::span<const RecordedEdge> edges, const Truth& truth,
                                       std::uint32_t first_vertices, Error error = Error::kNotRight);

// All of it for one pair of maps.
struct TruthResult {
  Truth truth;
  VerifierOptions thresholds;                        // those that the merge was run with
  std::uint64_t candidates = 0;                      // with min_votes or more
  std::uint64_t right_candidates = 0;                // of them
  PrecisionRecall chosen;                            // at `thresholds`
  std::uint64_t unlisted = 0;                        // accepted at `thresholds` and not listed at all: no shared view
  std::vector<PrecisionRecall> by_inliers;           // plausible candidates, score: inliers
  std::vector<PrecisionRecall> by_false_alarms;      // score: -log10 of the number of false alarms
  std::optional<SuggestedThresholds> without_error;  // precision 1
  std::optional<SuggestedThresholds> nearly;         // precision 0.999
  std::vector<RecallAtK> localization;
  std::uint32_t placed = 0;          // vertices of the second map whose place the first has
  std::uint32_t rightly_joined = 0;  // of them, with at least one right accepted pair
  // Graded truth: those that share kJoinableShare with some image of the first map and have kJoinableFeatures features.
  std::uint32_t joinable = 0;
  std::uint32_t joinable_joined = 0;
  double right_connectivity = 0;  // lambda_2 of the final component with its right edges only; share of the final value
};
inline constexpr double kJoinableShare = 0.3;
inline constexpr std::size_t kJoinableFeatures = 50;

// `input` and `evaluation` are of the merge that was run with `thresholds`; the truth is of its two maps.
TruthResult judge(std::vector<CandidateVerdict> verdicts, Truth truth, const MergeInput& input,
                  const Evaluation& evaluation, const VerifierOptions& thresholds);

}  // namespace mapweld::server::evaluation
