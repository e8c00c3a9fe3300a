#include "server/jobs/merge_jobs.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "schema/map_store.h"
#include "server/jobs/merge_job_rows.h"
#include "server/jobs/merge_pages.h"
#include "server/jobs/merge_run.h"
#include "server/jobs/merge_submission.h"
#include "server/jobs/pool_executor.h"
#include "server/jobs/run_control.h"

namespace mapweld::server {
namespace {

Timestamp now() { return std::chrono::floor<std::chrono::microseconds>(std::chrono::system_clock::now()); }

bool is_at_rest(JobState state) { return state != JobState::kQueued && state != JobState::kRunning; }

MergeRow require_merge(const Reader& db, JobId job) {
  std::optional<MergeRow> row = find_merge(db, job);
  if (!row) throw MergeJobError("no_such_merge", "There is no merge " + std::to_string(to_index(job)) + ".");
  return std::move(*row);
}

[[noreturn]] void refuse_state(const MergeRow& row, const std::string& wish) {
  throw MergeJobError("wrong_state", "Merge " + std::to_string(to_index(row.id)) + " is " +
                                         std::string(to_string(row.state)) + " and cannot be " + wish + ".");
}

}  // namespace

struct MergeJobs::Impl {
  Impl(Store& store, MergeJobOptions options) : store_(store), options_(std::move(options)) {
    if (options_.verify_threads > 1) {
      verifying_ = std::make_unique<WorkerPool>(options_.verify_threads - 1);
      executor_ = std::make_shared<PoolExecutor>(*verifying_);
    }
  }

  // A job without a worker changes its state only under `control_`, and is claimed by a worker under it; so whoever
  // holds it knows whether there is a worker to talk to. It is held over transactions, never while a job runs.
  std::mutex control_;

  std::mutex mutex_;  // guards what follows; held for moments only
  std::condition_variable work_;
  std::condition_variable rest_;  // a run has ended
  std::deque<JobId> queue_;
  std::map<JobId, std::shared_ptr<RunControl>> running_;
  std::map<JobId, std::string> unstored_failures_;  // the disk would not even take the failure
  bool stopping_ = false;

  Store& store_;
  MergeJobOptions options_;
  std::unique_ptr<WorkerPool> verifying_;  // verify_threads - 1 threads; none: no executor
  std::shared_ptr<const Executor> executor_;
  std::vector<std::thread> workers_;

  void start() {
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

  void shutdown() {
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

  void work() {
    while (const std::optional<JobId> job = next_job()) {
      const std::shared_ptr<RunControl> run = claim(*job);
      if (!run) continue;
      const RunOutcome outcome = run_merge(store_, *job, *run, options_, executor_);
      const std::lock_guard lock(mutex_);
      if (!outcome.is_stored) unstored_failures_[*job] = outcome.error;
      const auto found = running_.find(*job);
      if (found != running_.end() && found->second == run) running_.erase(found);
      rest_.notify_all();
    }
  }

  std::optional<JobId> next_job() {
    std::unique_lock lock(mutex_);
    work_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (stopping_) return std::nullopt;
    const JobId job = queue_.front();
    queue_.pop_front();
    return job;
  }

  // nullptr: the job is not to be run (any more).
  std::shared_ptr<RunControl> claim(JobId job) {
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

  void enqueue(JobId job) {
    {
      const std::lock_guard lock(mutex_);
      unstored_failures_.erase(job);
      queue_.push_back(job);
    }
    work_.notify_one();
  }

  std::shared_ptr<RunControl> run_of(JobId job) {
    const std::lock_guard lock(mutex_);
    const auto found = running_.find(job);
    return found == running_.end() ? nullptr : found->second;
  }

  void wait_for_end(JobId job, const std::shared_ptr<RunControl>& run) {
    std::unique_lock lock(mutex_);
    rest_.wait(lock, [&] {
      const auto found = running_.find(job);
      return found == running_.end() || found->second != run;
    });
  }

  // Moves a job that has no worker to `state`, from any of the states in `from`.
  void move_at_rest(JobId job, JobState state, std::initializer_list<JobState> from, const std::string& wish) {
    WriteTransaction db = store_.write();
    const MergeRow row = require_merge(db, job);
    if (std::ranges::find(from, row.state) == from.end()) refuse_state(row, wish);
    const RunEnd end{state, state == JobState::kPaused ? std::optional<std::string>("paused") : std::nullopt,
                     std::nullopt, now()};
    set_merge_state(db, job, row.state, end);
    db.commit();
  }

  // Tells the job's worker, or, when it has none, moves it itself.
  MergeStatus stop(JobId job, RunCommand command, JobState state, std::initializer_list<JobState> from,
                   const std::string& wish) {
    std::shared_ptr<RunControl> run;
    {
      const std::lock_guard control(control_);
      run = run_of(job);
      if (run) {
        run->command(command);
      } else {
        move_at_rest(job, state, from, wish);
        const std::lock_guard lock(mutex_);
        unstored_failures_.erase(job);
      }
    }
    if (run) {
      wait_for_end(job, run);
      const MergeRow row = require_merge(store_.read(), job);
      if (row.state != state) {
        // The run came to its own end before it heard of this.
        if (std::ranges::find(from, row.state) == from.end()) refuse_state(row, wish);
        return stop(job, command, state, from, wish);
      }
    }
    return get(job);
  }

  MergeStatus describe(const Reader& db, const MergeRow& row, const std::shared_ptr<RunControl>& run) {
    std::optional<MergeProgress> live;
    if (run && row.state == JobState::kRunning && row.epoch == run->epoch()) live = run->progress();
    MergeStatus status = status_of(row, list_members(db, row.map), live, now());
    if (!is_at_rest(row.state)) {
      const std::lock_guard lock(mutex_);
      const auto failure = unstored_failures_.find(row.id);
      if (failure != unstored_failures_.end()) {
        status.state = JobState::kFailed;
        status.stop_reason = "error";
        status.error = failure->second;
        status.eta_s.reset();
      }
    }
    return status;
  }

  MergeStatus get(JobId job) {
    const std::shared_ptr<RunControl> run = run_of(job);
    const ReadTransaction db = store_.read();
    return describe(db, require_merge(db, job), run);
  }
};

MergeJobs::MergeJobs(Store& store, MergeJobOptions options) : impl_(std::make_unique<Impl>(store, std::move(options))) {
  if (!impl_->options_.verifier) throw std::invalid_argument("merge jobs need a verifier");
}

MergeJobs::~MergeJobs() { shutdown(); }

void MergeJobs::start() { impl_->start(); }

void MergeJobs::shutdown() { impl_->shutdown(); }

MergeStatus MergeJobs::submit(const MergeRequest& request) {
  check(request);
  JobId job{};
  {
    WriteTransaction db = impl_->store_.write();
    job = store_submission(db, request, now());
    db.commit();
  }
  impl_->enqueue(job);
  return get(to_index(job));
}

MergeStatus MergeJobs::get(std::int64_t id) const { return impl_->get(JobId{id}); }

Page<MergeStatus> MergeJobs::list(std::optional<JobState> state, std::size_t limit,
                                  const std::optional<std::string>& after) const {
  std::optional<JobId> from;
  if (const auto number = parse_cursor(after)) from = JobId{*number};
  std::map<JobId, std::shared_ptr<RunControl>> runs;
  {
    const std::lock_guard lock(impl_->mutex_);
    runs = impl_->running_;
  }
  const ReadTransaction db = impl_->store_.read();
  const auto describe = [&](const MergeRow& row) {
    const auto run = runs.find(row.id);
    return impl_->describe(db, row, run == runs.end() ? nullptr : run->second);
  };
  return make_page<MergeStatus>(list_merges(db, limit + 1, from, state), limit, describe,
                                [](const MergeRow& row) { return to_index(row.id); });
}

Page<MergeCurvePoint> MergeJobs::curve(std::int64_t id, std::size_t limit,
                                       const std::optional<std::string>& after) const {
  const auto from = parse_cursor(after);
  const ReadTransaction db = impl_->store_.read();
  require_merge(db, JobId{id});
  return curve_page(db, JobId{id}, limit, from);
}

Page<MergeEdgePoint> MergeJobs::edges(std::int64_t id, std::size_t limit,
                                      const std::optional<std::string>& after) const {
  const auto from = parse_cursor(after);
  const ReadTransaction db = impl_->store_.read();
  require_merge(db, JobId{id});
  return edge_page(db, JobId{id}, limit, from);
}

MergeStatus MergeJobs::pause(std::int64_t id) {
  return impl_->stop(JobId{id}, RunCommand::kPause, JobState::kPaused, {JobState::kQueued, JobState::kRunning},
                     "paused");
}

MergeStatus MergeJobs::cancel(std::int64_t id) {
  return impl_->stop(
      JobId{id}, RunCommand::kCancel, JobState::kCancelled,
      {JobState::kQueued, JobState::kRunning, JobState::kPaused, JobState::kBudgetExhausted, JobState::kFailed},
      "cancelled");
}

MergeStatus MergeJobs::resume(std::int64_t id, const std::optional<MergeBudget>& budget) {
  if (budget) check(*budget);
  const JobId job{id};
  {
    const std::lock_guard control(impl_->control_);
    WriteTransaction db = impl_->store_.write();
    const MergeRow row = require_merge(db, job);
    bool has_failed_unstored = false;
    {
      const std::lock_guard lock(impl_->mutex_);
      has_failed_unstored = impl_->unstored_failures_.contains(job);
    }
    std::optional<std::string> new_budget;
    if (budget) new_budget = to_row(*budget);
    const bool is_resumable = row.state != JobState::kCancelled && (is_at_rest(row.state) || has_failed_unstored);
    const std::uint32_t gained = is_resumable ? extend_merged_map(db, row.map) : 0;
    switch (row.state) {
      case JobState::kPaused:
        break;
      case JobState::kBudgetExhausted:
      case JobState::kFailed:
        if (!new_budget) new_budget = to_row(MergeBudget{});
        break;
      case JobState::kCompleted:
        if (gained == 0) {
          throw MergeJobError("nothing_to_resume", "Merge " + std::to_string(id) +
                                                       " is complete: every candidate has been verified, and no "
                                                       "member has grown since.");
        }
        if (!new_budget) new_budget = to_row(MergeBudget{});
        break;
      case JobState::kQueued:
      case JobState::kRunning:
        if (has_failed_unstored) break;
        [[fallthrough]];
      case JobState::kCancelled:
        refuse_state(row, "resumed");
    }
    requeue_merge(db, job, new_budget, now());
    db.commit();
  }
  impl_->enqueue(job);
  return get(id);
}

void MergeJobs::remove(std::int64_t id) {
  const JobId job{id};
  std::shared_ptr<RunControl> run;
  {
    const std::lock_guard control(impl_->control_);
    run = impl_->run_of(job);
    WriteTransaction db = impl_->store_.write();
    switch (delete_merge(db, job)) {
      case DeleteOutcome::kNotFound:
        throw MergeJobError("no_such_merge", "There is no merge " + std::to_string(id) + ".");
      case DeleteOutcome::kInUse:
        throw MergeJobError("map_in_use", "Another merge uses the map that merge " + std::to_string(id) + " makes.");
      case DeleteOutcome::kDeleted:
        break;
    }
    db.commit();
    if (run) run->command(RunCommand::kAbandon);
    const std::lock_guard lock(impl_->mutex_);
    impl_->unstored_failures_.erase(job);
  }
  if (run) impl_->wait_for_end(job, run);
}

MergeStatus MergeJobs::wait(std::int64_t id, std::chrono::duration<double> timeout) const {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    MergeStatus status = get(id);
    if (is_at_rest(status.state)) return status;
    std::unique_lock lock(impl_->mutex_);
    if (std::chrono::steady_clock::now() >= deadline) return status;
    impl_->rest_.wait_for(lock, std::chrono::milliseconds(20));
  }
}

}  // namespace mapweld::server
