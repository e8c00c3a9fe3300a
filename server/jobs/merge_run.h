// One run of a job: from being taken by a worker to being at rest again.
#pragma once

#include <functional>
#include <string>

#include "schema/store.h"
#include "server/jobs/merge_job_options.h"
#include "server/jobs/run_control.h"

namespace mapweld::server {

struct RunOutcome {
  // The job is at rest in the store (or, after kShutDown, waits there as `running`), or it is gone: nothing to do.
  bool is_stored = true;
  std::string error;  // !is_stored: why, and what could not be written
};

// Loads the job, which `control.epoch()` has claimed, and steps it until it is done, its budget is spent or `control`
// has a command; writes checkpoints and curve points as it goes and the job's new state at the end. Blocks until then.
// A job that cannot go on becomes `failed`.
RunOutcome run_merge(Store& store, JobId job, RunControl& control, const MergeJobOptions& options,
                     std::shared_ptr<const Executor> executor);

}  // namespace mapweld::server
