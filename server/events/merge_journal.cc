#include "server/events/merge_journal.h"

#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "client/contract/json.h"
#include "client/contract/merge.h"
#include "schema/merges/merge_store.h"
#include "server/jobs/merge_job_rows.h"

namespace mapweld::server {

MergeJournal::MergeJournal(Store& store, MergeListener& next, LogFormat format)
    : store_(store),
      next_(next),
      format_(format),
      log_(spdlog::get("merges") ? spdlog::get("merges") : spdlog::default_logger()) {}

void MergeJournal::on_edge(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept {
  {
    const std::lock_guard lock(mutex_);
    ++totals_.edges;
    if (edge.confirmed) ++totals_.confirmed;
  }
  next_.on_edge(job, step, edge);
}

void MergeJournal::on_verdict(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept {
  {
    const std::lock_guard lock(mutex_);
    edge.confirmed ? ++totals_.confirmed : --totals_.confirmed;
  }
  next_.on_verdict(job, step, edge);
}

void MergeJournal::on_progress(JobId job, const MergeProgress& progress) noexcept {
  {
    const std::lock_guard lock(mutex_);
    count(job, progress.verifications);
  }
  next_.on_progress(job, progress);
}

void MergeJournal::on_state(JobId job) noexcept {
  try {
    const std::lock_guard lock(mutex_);
    write_down(job);
  } catch (const std::exception& error) {
    spdlog::warn("merge {}: {}", to_index(job), error.what());
  }
  next_.on_state(job);
}

MergeTotals MergeJournal::totals() const {
  const std::lock_guard lock(mutex_);
  return totals_;
}

// `verifications` of the job until now; a restart begins again at none.
void MergeJournal::count(JobId job, std::uint64_t verifications) {
  const auto seen = seen_.find(job);
  if (seen == seen_.end()) return;
  const std::uint64_t before = std::exchange(seen->second.verifications, verifications);
  if (verifications > before) totals_.verifications += verifications - before;
}

void MergeJournal::write_down(JobId job) {
  const std::optional<MergeRow> row = find_merge(store_.read(), job);
  if (!row) {
    seen_.erase(job);
    return;
  }
  const std::string state(to_string(row->state));
  const bool is_new = !seen_.contains(job);
  Seen& seen = seen_[job];
  if (std::exchange(seen.state, state) == state) return;
  const MergeProgress progress = progress_of(*row);
  if (is_new) seen.verifications = row->spent.verifications;
  const bool begins = row->state == JobState::kRunning;
  if (!begins && !contract::is_at_rest(state)) return;
  begins ? void(seen.verifications = row->spent.verifications) : count(job, row->spent.verifications);
  contract::Json event = {
      {"event", "merge"}, {"merge", to_index(job)}, {"map", row->map_name}, {"method", row->method}, {"state", state}};
  if (row->stop_reason) event["stop_reason"] = *row->stop_reason;
  if (row->error) event["error"] = *row->error;
  event["verifications"] = row->spent.verifications;
  if (!begins) {
    event["edges"] = progress.edges;
    event["confirmed"] = progress.confirmed;
  }
  event["elapsed_s"] = std::round(row->spent.elapsed_s * 1e3) / 1e3;
  log_->log(row->error ? spdlog::level::warn : spdlog::level::info, spdlog::string_view_t(log_line(event, format_)));
}

}  // namespace mapweld::server
