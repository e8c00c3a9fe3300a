// What merges do, for those who look after a server: lines in its log, numbers in its metrics.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "schema/store.h"
#include "server/jobs/merge_listener.h"
#include "server/log.h"

namespace spdlog {
class logger;
}

namespace mapweld::server {

// What all merges together have done since the start.
struct MergeTotals {
  std::uint64_t verifications = 0;
  std::uint64_t edges = 0;      // verified
  std::uint64_t confirmed = 0;  // confirmations, less those taken back
};

// Hands on to `next` whatever it is told. One line at `info` when a merge begins to run, and one when it comes to rest.
// Thread-safe.
class MergeJournal final : public MergeListener {
 public:
  // Store and listener must outlive this.
  MergeJournal(Store& store, MergeListener& next, LogFormat format);

  void on_edge(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept override;
  void on_verdict(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept override;
  void on_progress(JobId job, const MergeProgress& progress) noexcept override;
  void on_state(JobId job) noexcept override;

  MergeTotals totals() const;

 private:
  void count(JobId job, std::uint64_t verifications);
  void write_down(JobId job);

  struct Seen {
    std::string state;
    std::uint64_t verifications = 0;
  };

  Store& store_;
  MergeListener& next_;
  const LogFormat format_;
  const std::shared_ptr<spdlog::logger> log_;
  mutable std::mutex mutex_;  // guards what follows
  std::map<JobId, Seen> seen_;
  MergeTotals totals_;
};

}  // namespace mapweld::server
