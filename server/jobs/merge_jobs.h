// Merge jobs: submitting them, following them, stopping and going on. The use cases behind /v1/merges
// (docs/http-api.md); no HTTP and no JSON here.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>

#include "core/types.h"
#include "schema/store.h"
#include "server/jobs/merge_job_options.h"
#include "server/jobs/merge_status.h"
#include "server/services/keep.h"

namespace mapweld::server {

class MergeWorkers;
class RunControl;
enum class RunCommand : std::uint8_t;

// Runs merge jobs on worker threads over the store. All functions may be called from any thread; every change is
// committed before they return.
class MergeJobs {
 public:
  // `store` must outlive this, whose end is a shutdown(). Throws std::invalid_argument without a verifier.
  MergeJobs(Store& store, MergeJobOptions options);
  ~MergeJobs();

  // Starts the workers. What was queued or running when the store was last closed goes on by itself.
  void start();
  // Checkpoints what runs, leaves it `running` in the store for the next start, and joins the workers. Idempotent.
  void shutdown();

  // Stores the job, the merged map and the members' watermarks in one transaction. Codes: too_few_members,
  // duplicate_member (also when one member is part of another), unknown_method, invalid_name, invalid_parameter,
  // invalid_budget, no_such_map, name_taken, vocabulary_mismatch, wrong_state (a member whose own merge is running).
  MergeStatus submit(const MergeRequest& request, const Keep<MergeStatus>& keep = {});

  // While a job runs here its numbers are those of the moment, at most `metrics_interval_s` old where eigenvalues
  // allow; otherwise those of its last checkpoint. no_such_merge, as all below.
  MergeStatus get(std::int64_t id) const;
  // By id; of merges whose merged map has a name that is `visible`, when that is given.
  Page<MergeStatus> list(std::optional<JobState> state, std::size_t limit, const std::optional<std::string>& after,
                         const std::function<bool(const std::string& map)>& visible = {}) const;
  std::string map_of(std::int64_t id) const;  // the merged map's name
  Page<MergeCurvePoint> curve(std::int64_t id, std::size_t limit, const std::optional<std::string>& after) const;
  Page<MergeEdgePoint> edges(std::int64_t id, std::size_t limit, const std::optional<std::string>& after) const;

  // Stops a queued or running job at its next step; it is paused and checkpointed when this returns.
  MergeStatus pause(std::int64_t id, const Keep<MergeStatus>& keep = {});
  // A budget is an allowance on top of what was spent; without one, `paused` keeps its remainder and the other states
  // run unlimited. What the members have gained since is taken in, in the same transaction. Serves paused,
  // budget_exhausted, failed, and completed when a member has grown or other images of it are deleted
  // ("nothing_to_resume" otherwise).
  MergeStatus resume(std::int64_t id, const std::optional<MergeBudget>& budget, const Keep<MergeStatus>& keep = {});
  // Begins the merge afresh, from any state at rest: in one transaction its edges, its curve and all that it was and
  // had spent go, what the members have gained is taken in, and it is queued with `budget`, or with all of the one that
  // it had. Id, map and its numbers of vertices, members, method, seed and parameters stay. "map_in_use" when another
  // merge names the merged map, "wrong_state" also when a member's own merge is not at rest.
  MergeStatus restart(std::int64_t id, const std::optional<MergeBudget>& budget, const Keep<MergeStatus>& keep = {});
  // Final, but for a restart; the edges so far stay.
  MergeStatus cancel(std::int64_t id, const Keep<MergeStatus>& keep = {});
  // In any state: stops the job at its next step, then removes the job, its merged map and its inter edges in one
  // transaction. "map_in_use" when another merge names the merged map.
  void remove(std::int64_t id);

  // Waits until the job is neither queued nor running, or the time is up.
  MergeStatus wait(std::int64_t id, std::chrono::duration<double> timeout) const;

 private:
  // Tells the job's worker, or, when it has none, moves it to `state` itself, from any of the states in `from`.
  MergeStatus stop(JobId job, RunCommand command, JobState state, std::initializer_list<JobState> from,
                   const std::string& wish, const Keep<MergeStatus>& keep);
  MergeStatus describe(const Reader& db, const MergeRow& row, const std::shared_ptr<RunControl>& run) const;
  static MergeStatus describe_queued(const Reader& db, JobId job);

  Store& store_;
  std::unique_ptr<MergeWorkers> workers_;
};

}  // namespace mapweld::server
