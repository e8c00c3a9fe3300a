// Several methods on one pair of maps, and what is to be said about them (paper, section VI).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/guard/verdict.h"
#include "core/guard/verified_edge.h"
#include "core/merge/merge_input.h"
#include "server/evaluation/curves.h"
#include "server/evaluation/limit.h"
#include "server/evaluation/recorded_run.h"
#include "server/evaluation/summary.h"

namespace mapweld::server::evaluation {

// The baseline, which always runs.
inline constexpr std::string_view kBaseline = "brute-force";

struct EvaluationOptions {
  std::vector<std::string> methods;              // empty: all of merge_methods(); the baseline is added where missing
  std::uint32_t runs = 20;                       // of each method that draws at random; of any other one
  std::uint64_t seed = 0;                        // the runs have the seeds seed .. seed + runs - 1
  bool memo = false;                             // share verdicts between methods: then seconds mean nothing
  double modelled_verifier_s = 0.02;             // of a verifier better and slower than ours
  std::vector<double> levels{.5, .9, .95, .99};  // shares of the final value, ascending
  double share_of_baseline = 0.1;                // where qualities are compared (figure 5)
  std::uint32_t curve_points = 24;               // wanted for each run, see RunCurve::points
  bool guard = false;                            // judge the finished merge's edges as the alias guard does,
  std::vector<VerifiedEdge> inner_edges;         // by these of the members, in merged numbers;
  bool confirmed = false;                        // and count only the edges that it confirms in the end
  double min_confidence = GuardOptions{}.min_confidence;  // of a confirmed edge
  int threads = 1;  // for eigenvalues; merging itself has one, so that it can be timed
};

// What it took to reach one level, over the runs that did.
struct LevelCost {
  double level = 0;
  std::uint32_t reached = 0;  // runs
  Summary verifications = {};
  Summary time_s = {};
  Summary modelled_time_s = {};
  Summary edges = {};
  Summary joined_vertices = {};
  Summary independent_joins = {};
};

// The state at a share of the baseline's whole cost along one axis.
struct QualityAtShare {
  CostAxis axis = CostAxis::kTime;
  double budget = 0;          // that share of the baseline's cost, in the axis's unit
  Summary connectivity = {};  // share of the final value, 0..1
  Summary joined_vertices = {};
  Summary independent_joins = {};
};

struct MethodResult {
  std::string method;
  std::vector<RecordedRun> runs;                // their edges: those that count
  std::vector<std::vector<CurvePoint>> curves;  // by run, ascending by edges
  std::vector<LevelCost> levels;                // as the options' levels
  std::vector<QualityAtShare> at_share;         // time, verifications, modelled time
  Summary verifications;                        // of the whole merge
  Summary time_s;
  Summary modelled_time_s;
  // Every run ended with the edges that all methods found together, of those that count. Not so where a method leaves
  // candidates out, as `alignment` does.
  bool is_complete = true;
};

struct Evaluation {
  EvaluationOptions options;
  std::vector<std::uint32_t> member_vertices;
  std::uint64_t inner_edges = 0;
  std::uint64_t candidates = 0;                  // pairs with min_votes or more
  double index_s = 0;                            // building the word index, once, charged to nobody
  std::uint32_t components = 0;                  // of the finished merge
  std::uint32_t final_vertices = 0;              // of its largest component
  double final_connectivity = 0;                 // lambda_2 on it
  Limit limit;                                   // what there is to be had of it
  CurvePoint finished;                           // edges that count, joined vertices and independent joins in the end
  std::vector<RecordedEdge> all_edges;           // verified ones, by (u, v); their cost is meaningless
  std::optional<std::uint64_t> confirmed_edges;  // of them; none: they were not judged
  std::vector<MethodResult> methods;             // as asked for

  const MethodResult* find(std::string_view method) const;
  // Those of all_edges that quality is measured by: all, or with the option `confirmed` the confirmed ones.
  std::vector<RecordedEdge> counted_edges() const;
};

// The edges within the members that the alias guard confirms: a guarded merge rests on them alone, and so does an
// evaluation with the option `confirmed`, as its input's inner_edges.
std::vector<Edge> confirmed_inner_edges(const MergeInput& input, std::span<const VerifiedEdge> inner_edges,
                                        double min_confidence = GuardOptions{}.min_confidence);

// Told what is being done: stage, which run of how many, and how far it is.
struct EvaluationProgress {
  std::string stage;
  std::uint64_t done = 0;
  std::uint64_t total = 0;
};
using EvaluationObserver = std::function<void(const EvaluationProgress&)>;

// Merges `input` by every method, one run after the other on the calling thread, and computes the curves. The input's
// own method and seed are not used. With `memo`, `input.verifier` should be a MemoVerifier. `observer` may be called
// from other threads, one at a time. Throws std::invalid_argument for a method that there is not, and for `confirmed`
// without `guard`.
Evaluation evaluate(MergeInput input, const EvaluationOptions& options, const EvaluationObserver& observer = {});

}  // namespace mapweld::server::evaluation
