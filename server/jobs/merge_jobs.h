// Merge jobs: submitting them, following them, stopping and going on. The use cases behind /v1/merges
// (docs/http-api.md); no HTTP and no JSON here.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pair_verifier.h"
#include "core/guard/guard_evidence.h"
#include "core/merge/member_table.h"
#include "core/types.h"
#include "schema/merge_store.h"
#include "schema/store.h"

namespace mapweld::server {

// A request that cannot be served; `code` is the stable word of http-api.md: "no_such_merge", "no_such_map",
// "wrong_state", "nothing_to_resume", "name_taken", "map_in_use", "vocabulary_mismatch", "duplicate_member",
// "too_few_members", "unknown_method", "invalid_budget", "invalid_parameter", "invalid_name". Nothing stored has
// changed.
class MergeJobError : public std::runtime_error {
 public:
  MergeJobError(std::string code, const std::string& detail) : std::runtime_error(detail), code_(std::move(code)) {}
  const std::string& code() const { return code_; }

 private:
  std::string code_;
};

// What a run may spend; absent: unlimited. Whichever is reached first stops it.
struct MergeBudget {
  std::optional<double> seconds;               // > 0; of elapsed_s: steps, checkpoints and metrics, the last ones too
  std::optional<std::uint64_t> verifications;  // > 0; to the very number
  std::optional<std::uint64_t> edges;          // > 0
  std::optional<double> fraction_of_maximum;   // in (0, 1]; tested at fixed numbers of verifications
  bool certified = false;                      // judge the fraction by the certificate, not by the estimate
  friend bool operator==(const MergeBudget&, const MergeBudget&) = default;
};

struct MergeParameters {
  std::uint32_t min_votes = 10;                                  // 1 .. 65535
  int min_inliers = 10;                                          // 4 .. 65535
  double max_false_alarms = VerifierOptions{}.max_false_alarms;  // > 0
  VoteRule votes = VoteRule::kMin;
  bool alias_guard = false;  // confirm only what core/guard/alias_guard.h confirms; otherwise every edge is
  double min_confidence = kDefaultMinConfidence;  // of a confirmed edge, where the guard judges; 0 .. 1
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
  std::optional<std::string> stop_reason;  // seconds, verifications, edges, fraction_of_maximum, paused, error
  std::optional<std::string> error;
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

// Makes the verifier that a job's pairs are put to; called once a run.
using VerifierFactory = std::function<std::shared_ptr<const PairVerifier>(const VerifierOptions&)>;

struct MergeJobOptions {
  VerifierFactory verifier;            // required
  int workers = 1;                     // jobs that run at the same time
  int verify_threads = 1;              // on which a job verifies pairs; the merge is the same for any number
  double checkpoint_interval_s = 0.5;  // between checkpoints, where they are cheap enough
  double checkpoint_cost_share = 0.1;  // of a job's time at most: a checkpoint of d seconds waits for d / share more
  double metrics_interval_s = 0.2;     // between exact eigenvalues, and how old what is polled may be
  double metrics_cost_share = 0.1;
  std::function<void(const std::string&)> log;  // told of runs that fail or cannot be stored; may be empty
};

// Runs merge jobs on worker threads over the store. All functions may be called from any thread; every change is
// committed before they return.
class MergeJobs {
 public:
  // `store` must outlive this.
  MergeJobs(Store& store, MergeJobOptions options);
  ~MergeJobs();  // shutdown()
  MergeJobs(const MergeJobs&) = delete;
  MergeJobs& operator=(const MergeJobs&) = delete;

  // Starts the workers. What was queued or running when the store was last closed goes on by itself.
  void start();
  // Checkpoints what runs, leaves it `running` in the store for the next start, and joins the workers. Idempotent.
  void shutdown();

  // Stores the job, the merged map and the members' watermarks in one transaction. Codes: too_few_members,
  // duplicate_member (also when one member is part of another), unknown_method, invalid_name, invalid_parameter,
  // invalid_budget, no_such_map, name_taken, vocabulary_mismatch, wrong_state (a member whose own merge is running).
  MergeStatus submit(const MergeRequest& request);

  // While a job runs here its numbers are those of the moment, at most `metrics_interval_s` old where eigenvalues
  // allow; otherwise those of its last checkpoint. no_such_merge, as all below.
  MergeStatus get(std::int64_t id) const;
  Page<MergeStatus> list(std::optional<JobState> state, std::size_t limit,
                         const std::optional<std::string>& after) const;  // by id
  Page<MergeCurvePoint> curve(std::int64_t id, std::size_t limit, const std::optional<std::string>& after) const;
  Page<MergeEdgePoint> edges(std::int64_t id, std::size_t limit, const std::optional<std::string>& after) const;

  // Stops a queued or running job at its next step; it is paused and checkpointed when this returns.
  MergeStatus pause(std::int64_t id);
  // A budget is an allowance on top of what was spent; without one, `paused` keeps its remainder and the other states
  // run unlimited. What the members have gained since is taken in, in the same transaction. Serves paused,
  // budget_exhausted, failed, and completed when a member has grown ("nothing_to_resume" otherwise).
  MergeStatus resume(std::int64_t id, const std::optional<MergeBudget>& budget);
  // Final; the edges so far stay.
  MergeStatus cancel(std::int64_t id);
  // In any state: stops the job at its next step, then removes the job, its merged map and its inter edges in one
  // transaction. "map_in_use" when another merge names the merged map.
  void remove(std::int64_t id);

  // Waits until the job is neither queued nor running, or the time is up.
  MergeStatus wait(std::int64_t id, std::chrono::duration<double> timeout) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mapweld::server
