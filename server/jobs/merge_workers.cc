#include "server/jobs/merge_workers.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>

#include "schema/merges/merge_store.h"
#include "server/jobs/merge_listener.h"
#include "server/jobs/merge_run.h"
#include "server/services/times.h"

namespace mapweld::server {

MergeWorkers::MergeWorkers(Store& store, MergeJobOptions options) : store_(store), options_(std::move(options)) {
  if (!options_.verifier) throw std::invalid_argument("merge jobs need a verifier");
  if (options_.verify_threads > 1) {
    verifying_ = std::make_unique<WorkerPool>(options_.verify_threads - 1);
    executor_ = std::make_shared<PoolExecutor>(*verifying_);
  }
}

MergeWorkers::~MergeWorkers() { stop(); }

void MergeWorkers::start() {
  const std::lock_guard control(control_);
  if (!workers_.empty()) return;
  std::vector<JobId> waiting;
  {
    WriteTransaction db = store_.write();
    waiting = recover_merges(db, now());
    db.commit();
  }
  {
    const std::lock_guard lock(mutex_);
    stopping_ = false;
    queue_.assign(waiting.begin(), waiting.end());
  }
  for (int i = 0; i < std::max(1, options_.workers); ++i) workers_.emplace_back([this] { work(); });
}

void MergeWorkers::stop() {
  std::vector<std::thread> workers;
  {
    const std::lock_guard control(control_);
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (const auto& [job, run] : running_) run->command(RunCommand::kShutDown);
    workers.swap(workers_);
  }
  work_.notify_all();
  for (std::thread& worker : workers) worker.join();
}

void MergeWorkers::work() {
  while (const std::optional<JobId> job = next_job()) {
    const std::shared_ptr<RunControl> run = claim(*job);
    if (!run) continue;
    tell_state(*job);
    const RunOutcome outcome = run_merge(store_, *job, *run, options_, executor_);
    tell_state(*job);
    const std::lock_guard lock(mutex_);
    if (!outcome.is_stored) unstored_failures_[*job] = outcome.error;
    const auto found = running_.find(*job);
    if (found != running_.end() && found->second == run) running_.erase(found);
    rest_.notify_all();
  }
}

std::optional<JobId> MergeWorkers::next_job() {
  std::unique_lock lock(mutex_);
  work_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
  if (stopping_) return std::nullopt;
  const JobId job = queue_.front();
  queue_.pop_front();
  return job;
}

std::shared_ptr<RunControl> MergeWorkers::claim(JobId job) {
  const std::lock_guard control(control_);
  try {
    WriteTransaction db = store_.write();
    const std::optional<std::uint64_t> epoch = claim_merge(db, job, now());
    if (!epoch) return nullptr;
    db.commit();
    auto run = std::make_shared<RunControl>(*epoch);
    const std::lock_guard lock(mutex_);
    if (stopping_) run->command(RunCommand::kShutDown);
    running_[job] = run;
    return run;
  } catch (const std::exception& error) {  // the job stays queued, for the next start
    if (options_.log) options_.log("merge " + std::to_string(to_index(job)) + " could not be begun: " + error.what());
    const std::lock_guard lock(mutex_);
    unstored_failures_[job] = error.what();
    rest_.notify_all();
    return nullptr;
  }
}

void MergeWorkers::enqueue(JobId job) {
  {
    const std::lock_guard lock(mutex_);
    unstored_failures_.erase(job);
    queue_.push_back(job);
  }
  work_.notify_one();
}

void MergeWorkers::tell_state(JobId job) const {
  if (options_.listener) options_.listener->on_state(job);
}

std::shared_ptr<RunControl> MergeWorkers::run_of(JobId job) const {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(job);
  return found == running_.end() ? nullptr : found->second;
}

std::map<JobId, std::shared_ptr<RunControl>> MergeWorkers::runs() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

void MergeWorkers::wait_for_end(JobId job, const std::shared_ptr<RunControl>& run) const {
  std::unique_lock lock(mutex_);
  rest_.wait(lock, [&] {
    const auto found = running_.find(job);
    return found == running_.end() || found->second != run;
  });
}

void MergeWorkers::wait_a_little() const {
  std::unique_lock lock(mutex_);
  rest_.wait_for(lock, std::chrono::milliseconds(20));
}

std::optional<std::string> MergeWorkers::unstored_failure(JobId job) const {
  const std::lock_guard lock(mutex_);
  const auto found = unstored_failures_.find(job);
  if (found == unstored_failures_.end()) return std::nullopt;
  return found->second;
}

void MergeWorkers::forget_failure(JobId job) {
  const std::lock_guard lock(mutex_);
  unstored_failures_.erase(job);
}

}  // namespace mapweld::server
