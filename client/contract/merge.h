// Merges: submitting one, following it, and what it leaves.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/contract/budget.h"
#include "client/contract/codec.h"
#include "client/contract/graph.h"

namespace mapweld::contract {

// The contract's words for methods, states and phases. A server may offer fewer methods.
inline constexpr std::array<std::string_view, 7> kMergeMethods = {
    "quickconnect", "brute-force", "random", "random-candidates", "degree-min", "alignment", "spectral"};
inline constexpr std::array<std::string_view, 7> kMergeStates = {"queued",    "running",   "paused", "budget_exhausted",
                                                                 "completed", "cancelled", "failed"};
inline constexpr std::array<std::string_view, 5> kMergePhases = {"voting", "exploration", "verification", "refinement",
                                                                 "done"};

// True for the states in which nothing moves until somebody asks for it: all but queued and running.
bool is_at_rest(std::string_view merge_state);

// Absent fields mean the server's defaults.
struct MergeParameters {
  std::optional<int> min_votes;
  std::optional<int> min_inliers;
  std::optional<double> max_false_alarms;  // an accepted pair's number of false alarms is at most this; > 0
  std::optional<std::string> votes;        // "min", "product" or "signatures"
  std::optional<bool> alias_guard;
  std::optional<double> min_confidence;  // of a confirmed edge, where the guard judges; 0 to 1
  std::optional<bool> serves_certificate;
  static constexpr auto fields() {
    using P = MergeParameters;
    return std::tuple(
        omitted_when_empty("min_votes", &P::min_votes), omitted_when_empty("min_inliers", &P::min_inliers),
        omitted_when_empty("max_false_alarms", &P::max_false_alarms), omitted_when_empty("votes", &P::votes),
        omitted_when_empty("alias_guard", &P::alias_guard), omitted_when_empty("min_confidence", &P::min_confidence),
        omitted_when_empty("serves_certificate", &P::serves_certificate));
  }
  friend bool operator==(const MergeParameters&, const MergeParameters&) = default;
};

// POST /v1/merges
struct SubmitMerge {
  std::vector<std::string> maps;      // two or more, plain or merged
  std::optional<std::string> name;    // of the merged map; absent: default_merge_name(maps)
  std::optional<std::string> method;  // one of kMergeMethods; absent: the server's default
  std::optional<std::int64_t> seed;   // 0 or more; absent: the server's default
  std::optional<MergeParameters> parameters;
  std::optional<Budget> budget;
  static constexpr auto fields() {
    using S = SubmitMerge;
    return std::tuple(required("maps", &S::maps), omitted_when_empty("name", &S::name),
                      omitted_when_empty("method", &S::method), omitted_when_empty("seed", &S::seed),
                      omitted_when_empty("parameters", &S::parameters), omitted_when_empty("budget", &S::budget));
  }
  friend bool operator==(const SubmitMerge&, const SubmitMerge&) = default;
};

// What a submission must obey beyond its types and before any map is looked up. Throws ContractError: too_few_members,
// duplicate_member, unknown_method, invalid_name, invalid_budget, invalid_parameter.
void check(const SubmitMerge& request);

// The name of a merged map that was given none: its members' names joined by "_", cut to the 64 bytes of a slug.
std::string default_merge_name(const std::vector<std::string>& maps);

// POST /v1/merges/{id}/resume and .../restart, whose body may also be empty.
struct RunMerge {
  std::optional<Budget> budget;  // resume: an allowance on top of what was spent
  static constexpr auto fields() { return std::tuple(omitted_when_empty("budget", &RunMerge::budget)); }
  friend bool operator==(const RunMerge&, const RunMerge&) = default;
};
void check(const RunMerge& request);  // throws ContractError(invalid_budget)

struct WordProgress {
  std::int64_t done = 0;
  std::int64_t total = 0;
  static constexpr auto fields() {
    return std::tuple(field("done", &WordProgress::done), field("total", &WordProgress::total));
  }
  friend bool operator==(const WordProgress&, const WordProgress&) = default;
};

struct CandidateProgress {
  std::int64_t known = 0;     // pairs whose votes have reached min_votes so far
  std::int64_t verified = 0;  // of them, with a verdict
  std::int64_t accepted = 0;  // of them, accepted
  static constexpr auto fields() {
    using C = CandidateProgress;
    return std::tuple(field("known", &C::known), field("verified", &C::verified), field("accepted", &C::accepted));
  }
  friend bool operator==(const CandidateProgress&, const CandidateProgress&) = default;
};

// What was found between two of a merge's members.
struct MemberPair {
  std::vector<std::string> maps;       // two
  std::int64_t verified = 0;           // candidates with a verdict
  std::int64_t accepted = 0;           // of them, edges
  std::int64_t confirmed = 0;          // of those
  EdgeCounts edge_counts;              // the last two again
  std::int64_t independent_joins = 0;  // the fewest images whose removal would split the two again
  std::string verdict = "undecided";   // joined, not_joined, ambiguous, undecided
  static constexpr auto fields() {
    using P = MemberPair;
    return std::tuple(field("maps", &P::maps), field("verified", &P::verified), field("accepted", &P::accepted),
                      field("confirmed", &P::confirmed), field("edge_counts", &P::edge_counts),
                      field("independent_joins", &P::independent_joins), field("verdict", &P::verdict));
  }
  friend bool operator==(const MemberPair&, const MemberPair&) = default;
};

// The last point from which the merge would go on after a crash.
struct MergeCheckpoint {
  std::int64_t step = 0;
  double age_s = 0;
  static constexpr auto fields() {
    return std::tuple(field("step", &MergeCheckpoint::step), field("age_s", &MergeCheckpoint::age_s));
  }
  friend bool operator==(const MergeCheckpoint&, const MergeCheckpoint&) = default;
};

struct MergeLinks {
  std::string self;
  std::string map;
  static constexpr auto fields() {
    return std::tuple(field("self", &MergeLinks::self), field("map", &MergeLinks::map));
  }
  friend bool operator==(const MergeLinks&, const MergeLinks&) = default;
};

// GET /v1/merges/{id}
struct Merge {
  std::int64_t id = 0;
  std::string state = "queued";  // one of kMergeStates
  std::string method;
  std::vector<std::string> maps;
  std::string map;  // the merged map's name
  std::int64_t seed = 0;
  MergeParameters parameters;
  std::string phase = "voting";  // one of kMergePhases
  std::int64_t step = 0;
  WordProgress words;
  CandidateProgress candidates;
  std::int64_t edges = 0;    // inter-map edges, verified ones
  EdgeCounts edge_counts;    // the same, and how many of them the merged map has
  std::int64_t revoked = 0;  // confirmations that were taken back so far, as evidence arrived
  std::int64_t components = 0;
  double algebraic_connectivity = 0;
  LargestComponent largest_component;
  std::vector<Joined> joined;
  std::int64_t independent_joins = 0;
  std::vector<MemberPair> pairs;  // each two members
  std::optional<double> certified_fraction;
  std::optional<double> estimated_fraction;
  std::optional<std::int64_t> joinable_vertices;
  double elapsed_s = 0;         // steps, checkpoints and metrics; not waiting, not loading
  Budget budget;                // as last given
  Budget remaining;             // what is left of it
  std::optional<double> eta_s;  // until the merge is complete; null while nothing can be said
  std::optional<MergeCheckpoint> checkpoint;
  std::optional<std::string> stop_reason;
  std::optional<std::string> error;  // of a failed merge
  std::string created_at;            // RFC 3339, UTC
  MergeLinks links;
  static constexpr auto fields() {
    using M = Merge;
    return std::tuple(
        field("id", &M::id), field("state", &M::state), field("method", &M::method), field("maps", &M::maps),
        field("map", &M::map), field("seed", &M::seed), field("parameters", &M::parameters), field("phase", &M::phase),
        field("step", &M::step), field("words", &M::words), field("candidates", &M::candidates),
        field("edges", &M::edges), field("edge_counts", &M::edge_counts), field("revoked", &M::revoked),
        field("components", &M::components), field("algebraic_connectivity", &M::algebraic_connectivity),
        field("largest_component", &M::largest_component), field("joined", &M::joined),
        field("independent_joins", &M::independent_joins), field("pairs", &M::pairs),
        field("certified_fraction", &M::certified_fraction), field("estimated_fraction", &M::estimated_fraction),
        field("joinable_vertices", &M::joinable_vertices), field("elapsed_s", &M::elapsed_s),
        field("budget", &M::budget), field("remaining", &M::remaining), field("eta_s", &M::eta_s),
        field("checkpoint", &M::checkpoint), field("stop_reason", &M::stop_reason), field("error", &M::error),
        field("created_at", &M::created_at), field("links", &M::links));
  }
  friend bool operator==(const Merge&, const Merge&) = default;
};

// GET /v1/merges/{id}/curve
struct CurvePoint {
  std::int64_t step = 0;
  double elapsed_s = 0;
  std::int64_t verifications = 0;
  std::int64_t edges = 0;                 // verified ones
  std::optional<EdgeCounts> edge_counts;  // null where an older server kept the point
  std::int64_t components = 0;
  double algebraic_connectivity = 0;
  LargestComponent largest_component;
  std::optional<double> certified_fraction;
  std::string phase;
  static constexpr auto fields() {
    using C = CurvePoint;
    return std::tuple(
        field("step", &C::step), field("elapsed_s", &C::elapsed_s), field("verifications", &C::verifications),
        field("edges", &C::edges), field("edge_counts", &C::edge_counts), field("components", &C::components),
        field("algebraic_connectivity", &C::algebraic_connectivity), field("largest_component", &C::largest_component),
        field("certified_fraction", &C::certified_fraction), field("phase", &C::phase));
  }
  friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};

// GET /v1/merges/{id}/edges, in order of insertion.
struct MergeEdge {
  std::int64_t u = 0;
  std::int64_t v = 0;
  std::int64_t votes = 0;
  int inliers = 0;
  std::int64_t verifications = 0;  // of the merge, when the edge was inserted
  double elapsed_s = 0;            // likewise
  bool confirmed = true;           // this and what follows: as it stands now
  std::optional<double> confidence;
  std::optional<std::string> reason;  // why it is not confirmed
  static constexpr auto fields() {
    using E = MergeEdge;
    return std::tuple(field("u", &E::u), field("v", &E::v), field("votes", &E::votes), field("inliers", &E::inliers),
                      field("verifications", &E::verifications), field("elapsed_s", &E::elapsed_s),
                      field("confirmed", &E::confirmed), field("confidence", &E::confidence),
                      omitted_when_empty("reason", &E::reason));
  }
  friend bool operator==(const MergeEdge&, const MergeEdge&) = default;
};

}  // namespace mapweld::contract
