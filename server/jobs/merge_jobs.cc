#include "server/jobs/merge_jobs.h"

#include <algorithm>
#include <map>
#include <utility>

#include "schema/maps/map_store.h"
#include "schema/merges/merge_state_store.h"
#include "server/jobs/merge_job_rows.h"
#include "server/jobs/merge_pages.h"
#include "server/jobs/merge_submission.h"
#include "server/jobs/merge_workers.h"
#include "server/jobs/run_control.h"
#include "server/services/times.h"
#include "server/services/visible_rows.h"

namespace mapweld::server {
namespace {

bool is_at_rest(JobState state) { return state != JobState::kQueued && state != JobState::kRunning; }

MergeRow require_merge(const Reader& db, JobId job) {
  std::optional<MergeRow> row = find_merge(db, job);
  if (!row) throw MergeJobError("no_such_merge", "There is no merge " + std::to_string(to_index(job)) + ".");
  return std::move(*row);
}

[[noreturn]] void refuse_in_use(JobId job) {
  throw MergeJobError("map_in_use",
                      "Another merge uses the map that merge " + std::to_string(to_index(job)) + " makes.");
}

[[noreturn]] void refuse_state(const MergeRow& row, const std::string& wish) {
  throw MergeJobError("wrong_state", "Merge " + std::to_string(to_index(row.id)) + " is " +
                                         std::string(to_string(row.state)) + " and cannot be " + wish + ".");
}

// Moves a job that has no worker to `state`, from any of the states in `from`.
void move_at_rest(WriteTransaction& db, JobId job, JobState state, std::initializer_list<JobState> from,
                  const std::string& wish) {
  const MergeRow row = require_merge(db, job);
  if (std::ranges::find(from, row.state) == from.end()) refuse_state(row, wish);
  const RunEnd end{state, state == JobState::kPaused ? std::optional<std::string>("paused") : std::nullopt,
                   std::nullopt, now()};
  set_merge_state(db, job, row.state, end);
}

}  // namespace

MergeJobs::MergeJobs(Store& store, MergeJobOptions options)
    : store_(store), workers_(std::make_unique<MergeWorkers>(store, std::move(options))) {}

MergeJobs::~MergeJobs() = default;

void MergeJobs::start() { workers_->start(); }

void MergeJobs::shutdown() { workers_->stop(); }

MergeStatus MergeJobs::describe(const Reader& db, const MergeRow& row, const std::shared_ptr<RunControl>& run) const {
  std::optional<MergeProgress> live;
  if (run && row.state == JobState::kRunning && row.epoch == run->epoch()) live = run->progress();
  MergeStatus status = status_of(row, list_members(db, row.map), live, now());
  if (is_at_rest(row.state)) {
    status.is_outdated = row.checkpoint_at && has_other_absence(db, row.id, row.map);
    return status;
  }
  if (const std::optional<std::string> failure = workers_->unstored_failure(row.id)) {
    status.state = JobState::kFailed;
    status.stop_reason = "error";
    status.error = *failure;
    status.eta_s.reset();
  }
  return status;
}

// A job that is being queued: what failed before is forgotten with that.
MergeStatus MergeJobs::describe_queued(const Reader& db, JobId job) {
  const MergeRow row = require_merge(db, job);
  return status_of(row, list_members(db, row.map), std::nullopt, now());
}

MergeStatus MergeJobs::submit(const MergeRequest& request, const Keep<MergeStatus>& keep) {
  check(request);
  JobId job{};
  {
    WriteTransaction db = store_.write();
    job = store_submission(db, request, now());
    if (keep) keep(db, describe_queued(db, job));
    db.commit();
  }
  workers_->tell_state(job);
  workers_->enqueue(job);
  return get(to_index(job));
}

MergeStatus MergeJobs::get(std::int64_t id) const {
  const JobId job{id};
  const std::shared_ptr<RunControl> run = workers_->run_of(job);
  const ReadTransaction db = store_.read();
  return describe(db, require_merge(db, job), run);
}

Page<MergeStatus> MergeJobs::list(std::optional<JobState> state, std::size_t limit,
                                  const std::optional<std::string>& after,
                                  const std::function<bool(const std::string& map)>& visible) const {
  std::optional<JobId> from;
  if (const auto number = parse_cursor(after)) from = JobId{*number};
  const std::map<JobId, std::shared_ptr<RunControl>> runs = workers_->runs();
  const ReadTransaction db = store_.read();
  const auto describe_row = [&](const MergeRow& row) {
    const auto run = runs.find(row.id);
    return describe(db, row, run == runs.end() ? nullptr : run->second);
  };
  const auto rows = read_visible(
      limit + 1, from,
      [&](std::size_t count, const std::optional<JobId>& last) { return list_merges(db, count, last, state); },
      [&](const MergeRow& row) { return !visible || visible(find_map(db, row.map).value().name); });
  return make_page<MergeStatus>(rows, limit, describe_row, [](const MergeRow& row) { return to_index(row.id); });
}

std::string MergeJobs::map_of(std::int64_t id) const {
  const ReadTransaction db = store_.read();
  return find_map(db, require_merge(db, JobId{id}).map).value().name;
}

Page<MergeCurvePoint> MergeJobs::curve(std::int64_t id, std::size_t limit,
                                       const std::optional<std::string>& after) const {
  const auto from = parse_cursor(after);
  const ReadTransaction db = store_.read();
  require_merge(db, JobId{id});
  return curve_page(db, JobId{id}, limit, from);
}

Page<MergeEdgePoint> MergeJobs::edges(std::int64_t id, std::size_t limit,
                                      const std::optional<std::string>& after) const {
  const auto from = parse_cursor(after);
  const ReadTransaction db = store_.read();
  require_merge(db, JobId{id});
  return edge_page(db, JobId{id}, limit, from);
}

MergeStatus MergeJobs::stop(JobId job, RunCommand command, JobState state, std::initializer_list<JobState> from,
                            const std::string& wish, const Keep<MergeStatus>& keep) {
  const auto keep_when_there = [&](WriteTransaction& db) {
    const std::optional<MergeRow> row = keep ? find_merge(db, job) : std::nullopt;
    if (row && row->state == state) keep(db, describe(db, *row, nullptr));
  };
  std::shared_ptr<RunControl> run;
  {
    const auto control = workers_->control();
    run = workers_->run_of(job);
    if (run) {
      run->command(command, keep_when_there);
    } else {
      WriteTransaction db = store_.write();
      move_at_rest(db, job, state, from, wish);
      keep_when_there(db);
      db.commit();
      workers_->forget_failure(job);
      workers_->tell_state(job);
    }
  }
  if (run) {
    workers_->wait_for_end(job, run);
    const MergeRow row = require_merge(store_.read(), job);
    if (row.state != state) {
      // The run came to its own end before it heard of this.
      if (std::ranges::find(from, row.state) == from.end()) refuse_state(row, wish);
      return stop(job, command, state, from, wish, keep);
    }
  }
  return get(to_index(job));
}

MergeStatus MergeJobs::pause(std::int64_t id, const Keep<MergeStatus>& keep) {
  return stop(JobId{id}, RunCommand::kPause, JobState::kPaused, {JobState::kQueued, JobState::kRunning}, "paused",
              keep);
}

MergeStatus MergeJobs::cancel(std::int64_t id, const Keep<MergeStatus>& keep) {
  return stop(JobId{id}, RunCommand::kCancel, JobState::kCancelled,
              {JobState::kQueued, JobState::kRunning, JobState::kPaused, JobState::kBudgetExhausted, JobState::kFailed},
              "cancelled", keep);
}

MergeStatus MergeJobs::resume(std::int64_t id, const std::optional<MergeBudget>& budget,
                              const Keep<MergeStatus>& keep) {
  if (budget) check(*budget);
  const JobId job{id};
  {
    const auto control = workers_->control();
    WriteTransaction db = store_.write();
    const MergeRow row = require_merge(db, job);
    const bool has_failed_unstored = workers_->unstored_failure(job).has_value();
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
        if (gained == 0 && !has_other_absence(db, job, row.map)) {
          throw MergeJobError("nothing_to_resume", "Merge " + std::to_string(id) +
                                                       " is complete: every candidate has been verified, and no "
                                                       "member has other images since.");
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
    if (keep) keep(db, describe_queued(db, job));
    db.commit();
  }
  workers_->tell_state(job);
  workers_->enqueue(job);
  return get(id);
}

MergeStatus MergeJobs::restart(std::int64_t id, const std::optional<MergeBudget>& budget,
                               const Keep<MergeStatus>& keep) {
  if (budget) check(*budget);
  const JobId job{id};
  {
    const auto control = workers_->control();
    WriteTransaction db = store_.write();
    const MergeRow row = require_merge(db, job);
    if (!is_at_rest(row.state) && !workers_->unstored_failure(job)) refuse_state(row, "restarted");
    if (!list_merged_over(db, row.map).empty()) refuse_in_use(job);
    for (const MemberRow& member : list_members(db, row.map)) require_settled(db, member.map, member.name);
    extend_merged_map(db, row.map);
    restart_merge(db, job, budget ? std::optional(to_row(*budget)) : std::nullopt, now());
    if (keep) keep(db, describe_queued(db, job));
    db.commit();
  }
  workers_->tell_state(job);
  workers_->enqueue(job);
  return get(id);
}

void MergeJobs::remove(std::int64_t id) {
  const JobId job{id};
  std::shared_ptr<RunControl> run;
  {
    const auto control = workers_->control();
    run = workers_->run_of(job);
    WriteTransaction db = store_.write(Store::Purpose::kDelete);
    switch (delete_merge(db, job)) {
      case DeleteOutcome::kNotFound:
        throw MergeJobError("no_such_merge", "There is no merge " + std::to_string(id) + ".");
      case DeleteOutcome::kInUse:
        refuse_in_use(job);
      case DeleteOutcome::kDeleted:
        break;
    }
    db.commit();
    if (run) run->command(RunCommand::kAbandon);
    workers_->forget_failure(job);
    workers_->tell_state(job);
  }
  if (run) workers_->wait_for_end(job, run);
}

MergeStatus MergeJobs::wait(std::int64_t id, std::chrono::duration<double> timeout) const {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    MergeStatus status = get(id);
    if (is_at_rest(status.state)) return status;
    if (std::chrono::steady_clock::now() >= deadline) return status;
    workers_->wait_a_little();
  }
}

}  // namespace mapweld::server
