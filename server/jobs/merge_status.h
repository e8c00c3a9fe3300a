// What is asked of merge jobs and what they answer: requests, budgets, the numbers of a job at one moment, pages.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/contract/budget.h"
#include "core/errors.h"
#include "core/geometry/pair_verifier.h"
#include "core/guard/guard_evidence.h"
#include "core/merge/member_table.h"
#include "core/types.h"
#include "schema/merges/merge_store.h"

namespace mapweld::server {

// A request that cannot be served; `code` is the stable word of http-api.md: "no_such_merge", "no_such_map",
// "wrong_state", "nothing_to_resume", "name_taken", "map_in_use", "vocabulary_mismatch", "duplicate_member",
// "too_few_members", "unknown_method", "invalid_parameter", "invalid_name"; a budget is refused by contract::check.
// Nothing stored has changed.
class MergeJobError : public CodedError {
  using CodedError::CodedError;
};

// What a run may spend. Seconds are those of steps, checkpoints and metrics, the last ones too; verifications are met
// to the very number; the fraction is tested at fixed numbers of verifications.
using MergeBudget = contract::Budget;

struct MergeParameters {
  std::uint32_t min_votes = 10;                                  // 1 .. 65535
  int min_inliers = 10;                                          // 4 .. 65535
  double max_false_alarms = VerifierOptions{}.max_false_alarms;  // > 0
  VoteRule votes = VoteRule::kMin;
  bool alias_guard = false;  // confirm only what core/guard/alias_guard.h confirms; otherwise every edge is
  double min_confidence = kDefaultMinConfidence;  // of a confirmed edge, where the guard judges; 0 .. 1
  bool serves_certificate = false;                // of `spectral`: MergeOptions
  friend bool operator==(const MergeParameters&, const MergeParameters&) = default;
};

struct MergeRequest {
  std::vector<std::string> maps;  // members in the order that numbers the merged map's vertices; two or more
  std::string name;               // of the merged map
  std::string method = "quickconnect";
  std::uint64_t seed = 0;
  MergeParameters parameters;
  MergeBudget budget;
};

struct WordProgress {
  std::uint64_t done = 0;
  std::uint64_t total = 0;  // 0 for a method that does not go by words
};

struct CandidateProgress {
  std::uint64_t known = 0;  // pairs that have reached min_votes so far
  std::uint64_t verified = 0;
  std::uint64_t accepted = 0;
};

struct LargestComponent {
  std::uint64_t vertices = 0;
  double algebraic_connectivity = 0;
};

struct JoinedMember {
  std::string map;
  std::uint64_t vertices = 0;  // vertices of the member with an inter edge
};

// What was found between two of the members.
struct JoinedPair {
  std::string first;
  std::string second;
  MemberPairSummary summary;
};

struct CheckpointAge {
  std::uint64_t step = 0;
  double age_s = 0;
};

struct MergeStatus {
  std::int64_t id = 0;
  JobState state = JobState::kQueued;
  std::string method;
  std::vector<std::string> maps;
  std::string map;  // the merged map's name
  std::uint64_t seed = 0;
  MergeParameters parameters;
  std::string phase;  // voting, exploration, verification, refinement, done
  std::uint64_t step = 0;
  WordProgress words;
  CandidateProgress candidates;
  std::uint64_t edges = 0;            // verified ones
  std::uint64_t confirmed_edges = 0;  // of them: the edges that the merged map has
  std::uint64_t revoked = 0;          // confirmations that were taken back so far, as evidence arrived
  std::uint64_t components = 0;
  double algebraic_connectivity = 0;
  LargestComponent largest_component;
  std::vector<JoinedMember> joined;
  std::uint64_t independent_joins = 0;
  std::vector<JoinedPair> pairs;  // each two members
  std::optional<double> certified_fraction;
  std::optional<double> estimated_fraction;
  std::optional<std::uint64_t> joinable_vertices;
  double elapsed_s = 0;
  MergeBudget budget;           // as last given
  MergeBudget remaining;        // what is left of it
  std::optional<double> eta_s;  // until the merge is complete; null while nothing can be said honestly
  std::optional<CheckpointAge> checkpoint;
  std::optional<std::string> stop_reason;  // seconds, verifications, edges, fraction_of_maximum, paused, error;
                                           // while it runs: no_space, it waits for room on the disk
  std::optional<std::string> error;
  // At rest, and images of members have been deleted, restored or purged since the last checkpoint, which edges,
  // metrics and pairs here are of.
  bool is_outdated = false;
  Timestamp created_at;
};

struct MergeCurvePoint {
  std::uint64_t step = 0;
  double elapsed_s = 0;
  std::uint64_t verifications = 0;
  std::uint64_t edges = 0;                       // verified ones
  std::optional<std::uint64_t> confirmed_edges;  // of them; none: an older program kept this point
  std::uint64_t components = 0;
  double algebraic_connectivity = 0;
  LargestComponent largest_component;
  std::optional<double> certified_fraction;
  std::string phase;
};

struct MergeEdgePoint {
  VertexId u{};
  VertexId v{};
  std::uint32_t votes = 0;
  std::uint32_t inliers = 0;
  std::uint64_t verifications = 0;  // as they stood when the edge was inserted
  double elapsed_s = 0;
  bool confirmed = true;             // this and what follows: as it stands now
  std::optional<double> confidence;  // none: not judged
  std::string doubt;                 // why it is not confirmed
};

// A page of a list. `next` is the cursor of the page after it: give it back as `after`; empty at the end.
template <typename Item>
struct Page {
  std::vector<Item> items;
  std::optional<std::string> next;
};

}  // namespace mapweld::server
