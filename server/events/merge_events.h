// What merges do, as events.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "client/contract/merge.h"
#include "schema/store.h"
#include "server/events/event_hub.h"
#include "server/jobs/merge_listener.h"

namespace mapweld::server {

// How a merge stands: what its stream begins with.
std::vector<Event> standing_of(const contract::Merge& merge);

// Thread-safe.
class MergeEvents final : public MergeListener {
 public:
  // Both must outlive this.
  MergeEvents(Store& store, EventHub& hub) : store_(store), hub_(hub) {}

  void on_edge(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept override;
  void on_verdict(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept override;
  void on_progress(JobId job, const MergeProgress& progress) noexcept override;
  void on_state(JobId job) noexcept override;

 private:
  struct Told {
    std::string map;  // the merged one
    std::string state;
    std::string phase;
    std::chrono::steady_clock::time_point progress_at;
  };
  // Of the job, whose map is looked up when it is new, or `anew`: it may have another name. With `mutex_` held.
  Told& told_of(JobId job, bool anew = false);
  Event event_of(JobId job, const char* type, std::uint64_t step, const contract::Json& data);

  Store& store_;
  EventHub& hub_;
  std::mutex mutex_;
  std::map<JobId, Told> told_;
};

}  // namespace mapweld::server
