// Tables `merges`, `checkpoints` and `curve_points`: merge jobs and everything needed to go on after a crash.
//
// Fencing: a worker that takes a job gets a new epoch (`claim_merge`). Whatever it writes later names that epoch, and
// is refused when the job has been claimed again, or is gone: a late worker changes nothing.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// The states of http-api.md.
enum class JobState : std::uint8_t { kQueued, kRunning, kPaused, kBudgetExhausted, kCompleted, kCancelled, kFailed };
inline constexpr std::array kJobStates = {JobState::kQueued,          JobState::kRunning,   JobState::kPaused,
                                          JobState::kBudgetExhausted, JobState::kCompleted, JobState::kCancelled,
                                          JobState::kFailed};
std::string_view to_string(JobState state);
// nullopt for a word that is no state.
std::optional<JobState> parse_job_state(std::string_view word);

// What a job has used up; counted over all its runs.
struct Spent {
  double elapsed_s = 0;
  std::uint64_t verifications = 0;
  std::uint64_t edges = 0;
  friend bool operator==(const Spent&, const Spent&) = default;
};

struct NewMerge {
  MapId map{};         // the merged map, created in the same transaction
  std::string method;  // "quickconnect", ...
  std::uint64_t seed = 0;
  std::string parameters = "{}";  // JSON
  std::string budget = "{}";      // JSON, as given
  Timestamp created_at;
};

struct MergeRow : NewMerge {
  JobId id{};
  std::string map_name;
  JobState state = JobState::kQueued;
  std::string phase = "voting";
  std::optional<std::string> stop_reason;
  std::optional<std::string> error;
  std::uint64_t epoch = 0;      // grows with every claim
  Spent spent;                  // as of the last checkpoint
  Spent granted_at;             // what was spent when the budget was given: it is an allowance on top of that
  std::uint64_t step = 0;       // as of the last checkpoint
  std::string progress = "{}";  // JSON: numbers to show, as of the last checkpoint
  std::optional<Timestamp> checkpoint_at;  // none: no checkpoint yet
  Timestamp updated_at;
};

// Stores a queued job.
JobId insert_merge(WriteTransaction& db, const NewMerge& merge);

std::optional<MergeRow> find_merge(const Reader& db, JobId job);
// The merge that made a merged map.
std::optional<MergeRow> find_merge_of(const Reader& db, MapId merged);

// Up to `limit` jobs in order of id, those after `after`; only those in `state` when it is given.
std::vector<MergeRow> list_merges(const Reader& db, std::size_t limit, std::optional<JobId> after = {},
                                  std::optional<JobState> state = {});

// How many jobs are in each state; all states are there.
std::map<JobState, std::uint64_t> count_merges(const Reader& db);

// Takes a queued job for a worker: it becomes running, and the epoch that is returned its worker's. nullopt when it is
// not queued (any more).
std::optional<std::uint64_t> claim_merge(WriteTransaction& db, JobId job, Timestamp now);

// Puts a job back in line, with a new budget (JSON) when one is given; the allowance then counts from what is spent
// now. Earlier epochs are fenced off. False, and nothing changed, when there is no such job.
bool requeue_merge(WriteTransaction& db, JobId job, std::optional<std::string> budget, Timestamp now);

// Begins a job afresh: its inter edges, checkpoint, curve and everything that it has spent go, and it is put in line,
// with a new budget (JSON) when one is given; the rest of its row stays. Earlier epochs are fenced off. False, and
// nothing changed, when there is no such job.
bool restart_merge(WriteTransaction& db, JobId job, std::optional<std::string> budget, Timestamp now);

// One part of a job's state; a name and opaque bytes of any length (schema/blobs/merge_state_blob.h knows what is in
// them).
struct CheckpointPart {
  std::string name;
  std::span<const std::uint8_t> bytes;
};

struct CurvePointRow {
  std::uint64_t step = 0;
  double elapsed_s = 0;
  std::uint64_t verifications = 0;
  std::uint64_t edges = 0;                 // verified ones
  std::optional<std::uint64_t> confirmed;  // of them; none: not written down
  std::uint32_t components = 0;
  double algebraic_connectivity = 0;
  std::uint32_t largest_vertices = 0;  // of the largest component
  double largest_algebraic_connectivity = 0;
  std::optional<double> certified_fraction;
  std::string phase;
  friend bool operator==(const CurvePointRow&, const CurvePointRow&) = default;
};

// Everything that changed since the last checkpoint.
struct CheckpointWrite {
  std::uint64_t step = 0;
  std::string phase;
  Spent spent;
  std::optional<std::string> progress;          // JSON; none: as it was
  std::span<const CheckpointPart> parts;        // replace the parts of the same name; others stay
  std::span<const std::string> dropped_parts;   // names of parts that are no longer part of the state
  std::span<const NewEdge> edges;               // new inter edges in order of insertion
  VerifierId verifier{};                        // of the edges
  std::span<const CurvePointRow> curve_points;  // replace those of the same step
  Timestamp now;
};
// False, and nothing written, when the epoch is not the job's or the job is not running.
bool save_checkpoint(WriteTransaction& db, JobId job, std::uint64_t epoch, const CheckpointWrite& checkpoint);

// A budget of edges is an allowance on top of those there were when it was given. Deleted and restored images take
// edges from a state and give it others: what was `granted` when the state had `before` edges and has `after` without a
// step of the merge.
std::uint64_t granted_edges_in(std::uint64_t granted, std::uint64_t before, std::uint64_t after);

// Replaces parts of the checkpoint of a job that nobody runs, whose state has `edges` edges from now on.
void rewrite_checkpoint(WriteTransaction& db, JobId job, std::span<const CheckpointPart> parts, std::uint64_t edges);

struct StoredPart {
  std::string name;
  std::vector<std::uint8_t> bytes;
};
// The parts of the last checkpoint, by name; none before the first. Throws StoreError kCorrupt when one is damaged.
std::vector<StoredPart> load_checkpoint(const Reader& db, JobId job);
// One part of it; none when it has no part of this name. Reads no other. Throws as load_checkpoint.
std::optional<StoredPart> load_checkpoint_part(const Reader& db, JobId job, std::string_view part);

// Ends a run: the job leaves `running` for `state`. Call it in the transaction of the last checkpoint, so that state
// and edges agree. False, and nothing written, when the epoch is not the job's or the job is not running.
struct RunEnd {
  JobState state = JobState::kCompleted;
  std::optional<std::string> stop_reason;
  std::optional<std::string> error;
  Timestamp now;
};
bool end_run(WriteTransaction& db, JobId job, std::uint64_t epoch, const RunEnd& end);

// Changes the state of a job that no worker has (queued -> cancelled, paused -> cancelled, ...): fences off earlier
// epochs. False, and nothing changed, when its state is not `expected`.
bool set_merge_state(WriteTransaction& db, JobId job, JobState expected, const RunEnd& end);

// Points of the curve by step, those after `after`.
std::vector<CurvePointRow> list_curve(const Reader& db, JobId job, std::size_t limit,
                                      std::optional<std::uint64_t> after_step = {});

// Deletes a job with its merged map, inter edges, checkpoints and curve. Its members stay as they are. kInUse, and
// nothing changed, while another merged map names its map.
DeleteOutcome delete_merge(WriteTransaction& db, JobId job);

// To be called once, when a server starts: what was running when it stopped is queued again, earlier epochs are fenced
// off. Returns all queued jobs in order of id.
std::vector<JobId> recover_merges(WriteTransaction& db, Timestamp now);

}  // namespace mapweld
