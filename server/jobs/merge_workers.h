// Who runs merge jobs: the queue, the workers that claim jobs from it, and where a job that runs can be spoken to.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "schema/store.h"
#include "schema/store_types.h"
#include "server/jobs/merge_job_options.h"
#include "server/jobs/pool_executor.h"
#include "server/jobs/run_control.h"

namespace mapweld::server {

// Thread-safe.
class MergeWorkers {
 public:
  // `store` must outlive this. Throws std::invalid_argument without a verifier.
  MergeWorkers(Store& store, MergeJobOptions options);
  ~MergeWorkers();  // stop()
  MergeWorkers(const MergeWorkers&) = delete;
  MergeWorkers& operator=(const MergeWorkers&) = delete;

  // Starts the workers, with what was queued or running when the store was last closed.
  void start();
  // Tells what runs to checkpoint and to stay `running` in the store, and joins the workers. Idempotent.
  void stop();

  // A job without a worker changes its state only under this lock, and is claimed under it; so whoever holds it knows
  // whether there is a worker to talk to. It is held over transactions, never while a job runs.
  std::unique_lock<std::mutex> control() { return std::unique_lock(control_); }

  // Puts a job that is queued in the store in line.
  void enqueue(JobId job);
  // To the listener, when there is one: a job's state in the store may be another.
  void tell_state(JobId job) const;

  // The job's run; null while no worker has it.
  std::shared_ptr<RunControl> run_of(JobId job) const;
  std::map<JobId, std::shared_ptr<RunControl>> runs() const;
  // Blocks until this run of the job is over.
  void wait_for_end(JobId job, const std::shared_ptr<RunControl>& run) const;
  // Blocks until any run is over, 20 ms at most.
  void wait_a_little() const;

  // Why a job that waits or runs in the store does not: the disk would not even take its failure.
  std::optional<std::string> unstored_failure(JobId job) const;
  void forget_failure(JobId job);

 private:
  void work();
  std::optional<JobId> next_job();
  std::shared_ptr<RunControl> claim(JobId job);  // null: the job is not to be run (any more)

  Store& store_;
  const MergeJobOptions options_;
  std::unique_ptr<WorkerPool> verifying_;  // verify_threads - 1 threads; none: no executor
  std::shared_ptr<const Executor> executor_;
  std::vector<std::thread> workers_;  // guarded by control_

  std::mutex control_;

  mutable std::mutex mutex_;  // guards what follows; held for moments only, after control_
  std::condition_variable work_;
  mutable std::condition_variable rest_;  // a run has ended
  std::deque<JobId> queue_;
  std::map<JobId, std::shared_ptr<RunControl>> running_;
  std::map<JobId, std::string> unstored_failures_;
  bool stopping_ = false;
};

}  // namespace mapweld::server
