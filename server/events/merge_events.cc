#include "server/events/merge_events.h"

#include <exception>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "client/contract/codec.h"
#include "client/contract/json.h"
#include "schema/maps/map_store.h"
#include "schema/merges/merge_store.h"
#include "server/jobs/merge_job_rows.h"

namespace mapweld::server {
namespace {

using contract::Json;

constexpr std::chrono::milliseconds kProgressInterval{100};

template <typename Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json describe(std::int64_t merge, const MergeEdgePoint& edge) {
  return {{"merge", merge},
          {"u", to_index(edge.u)},
          {"v", to_index(edge.v)},
          {"votes", edge.votes},
          {"inliers", edge.inliers},
          {"verifications", edge.verifications},
          {"elapsed_s", edge.elapsed_s},
          {"confirmed", edge.confirmed},
          {"confidence", or_null(edge.confidence)}};
}

Json describe(std::int64_t merge, const MergeProgress& progress) {
  const std::optional<Certified>& certified = progress.certified;
  return {{"merge", merge},
          {"step", progress.step},
          {"phase", progress.phase},
          {"elapsed_s", progress.elapsed_s},
          {"eta_s", or_null(progress.eta_s)},
          {"words", {{"done", progress.words_done}, {"total", progress.words_total}}},
          {"candidates",
           {{"known", progress.candidates_known}, {"verified", progress.verifications}, {"accepted", progress.edges}}},
          {"edges", progress.edges},
          {"edge_counts", {{"verified", progress.edges}, {"confirmed", progress.confirmed}}},
          {"revoked", progress.revoked},
          {"components", progress.metrics.components},
          {"algebraic_connectivity", progress.metrics.algebraic_connectivity},
          {"largest_component",
           {{"vertices", progress.metrics.largest_vertices},
            {"algebraic_connectivity", progress.metrics.largest_algebraic_connectivity}}},
          {"certified_fraction", certified ? Json(certified->certified_fraction) : Json(nullptr)},
          {"estimated_fraction", certified ? Json(certified->estimated_fraction) : Json(nullptr)}};
}

Json state_document(std::int64_t merge, const std::string& map, const std::string& state, std::uint64_t step,
                    const std::string& phase, const std::optional<std::string>& stop_reason,
                    const std::optional<std::string>& error) {
  return {{"merge", merge},         {"map", map},     {"state", state},
          {"step", step},           {"phase", phase}, {"stop_reason", or_null(stop_reason)},
          {"error", or_null(error)}};
}

// What is told of listeners' own failures: nothing of a merge rests on them.
template <typename Tell>
void tell_safely(Tell&& tell) noexcept {
  try {
    tell();
  } catch (const std::exception& error) {
    spdlog::warn("an event of a merge is lost: {}", error.what());
  }
}

}  // namespace

std::vector<Event> standing_of(const contract::Merge& merge) {
  const std::string state =
      contract::dump(state_document(merge.id, merge.map, merge.state, static_cast<std::uint64_t>(merge.step),
                                    merge.phase, merge.stop_reason, merge.error));
  std::vector<Event> events{{.type = "state", .data = state}};
  if (contract::is_at_rest(merge.state)) events.push_back({.type = "done", .data = state});
  return events;
}

MergeEvents::Told& MergeEvents::told_of(JobId job, bool anew) {
  Told& told = told_[job];
  if (anew || told.map.empty()) {
    const ReadTransaction db = store_.read();
    const std::optional<MergeRow> merge = find_merge(db, job);
    if (const auto map = merge ? find_map(db, merge->map) : std::nullopt) told.map = map->name;
  }
  return told;
}

Event MergeEvents::event_of(JobId job, const char* type, std::uint64_t step, const Json& data) {
  return {.type = type, .data = contract::dump(data), .maps = {told_of(job).map}, .merge = to_index(job), .step = step};
}

void MergeEvents::on_edge(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept {
  tell_safely([&] {
    const std::lock_guard lock(mutex_);
    Json data = describe(to_index(job), edge);
    data["step"] = step;
    hub_.tell(event_of(job, "edge", step, data));
  });
}

void MergeEvents::on_verdict(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept {
  tell_safely([&] {
    const std::lock_guard lock(mutex_);
    Json data = describe(to_index(job), edge);
    data["step"] = step;
    if (!edge.confirmed) data["reason"] = edge.doubt;
    hub_.tell(event_of(job, edge.confirmed ? "confirmed" : "revoked", step, data));
  });
}

void MergeEvents::on_progress(JobId job, const MergeProgress& progress) noexcept {
  tell_safely([&] {
    const std::lock_guard lock(mutex_);
    Told& told = told_of(job);
    const auto now = std::chrono::steady_clock::now();
    const bool is_another_phase = std::exchange(told.phase, progress.phase) != progress.phase;
    if (!is_another_phase && now < told.progress_at + kProgressInterval) return;
    told.progress_at = now;
    told_of(job, true);
    if (is_another_phase) {
      hub_.tell(event_of(job, "phase", progress.step,
                         {{"merge", to_index(job)}, {"phase", progress.phase}, {"step", progress.step}}));
    }
    hub_.tell(event_of(job, "progress", progress.step, describe(to_index(job), progress)));
  });
}

void MergeEvents::on_state(JobId job) noexcept {
  tell_safely([&] {
    const std::lock_guard lock(mutex_);
    const std::optional<MergeRow> row = find_merge(store_.read(), job);
    if (!row) {
      told_.erase(job);
      return;
    }
    const std::string state(to_string(row->state));
    Told& told = told_of(job, true);
    if (std::exchange(told.state, state) == state) return;
    const MergeProgress progress = progress_of(*row);
    const Json document =
        state_document(to_index(job), told.map, state, row->step, progress.phase, row->stop_reason, row->error);
    if (contract::is_at_rest(state)) {
      MergeProgress last = progress;
      last.elapsed_s = row->spent.elapsed_s;
      hub_.tell(event_of(job, "progress", row->step, describe(to_index(job), last)));
      told.phase.clear();
    }
    hub_.tell(event_of(job, "state", row->step, document));
    if (contract::is_at_rest(state)) hub_.tell(event_of(job, "done", row->step, document));
  });
}

}  // namespace mapweld::server
