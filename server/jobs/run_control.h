// What passes between the worker that runs a job and the threads that ask about it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/merge/member_table.h"
#include "core/merge/merge_metrics.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld::server {

// What a running job is told to do at its next step. A later command only counts when it is stronger.
enum class RunCommand : std::uint8_t {
  kNone,
  kShutDown,  // checkpoint, and stay `running` in the store
  kPause,
  kCancel,
  kAbandon,  // the job is gone: write nothing more
};

// How much of what a merge can still reach it has reached (core/merge/certificate/certificate.h).
struct Certified {
  double certified_fraction = 0;
  double estimated_fraction = 0;
  std::uint64_t joinable_vertices = 0;
};

// The numbers of a job at one moment; what a status shows and a checkpoint's `progress` keeps.
struct MergeProgress {
  std::string phase = "voting";
  bool waits_for_space = false;  // the disk is full; the run goes on when it is not
  std::uint64_t step = 0;
  std::uint64_t words_done = 0;
  std::uint64_t words_total = 0;
  std::uint64_t candidates_known = 0;
  std::uint64_t verifications = 0;
  std::uint64_t edges = 0;      // verified ones
  std::uint64_t confirmed = 0;  // of them, as of the metrics
  std::uint64_t revoked = 0;    // confirmations that were taken back so far
  double elapsed_s = 0;
  std::optional<double> eta_s;
  MergeMetrics metrics;
  std::optional<Certified> certified;      // none while votes are still to be counted
  std::vector<MemberPairSummary> members;  // each two of them
  std::optional<std::uint64_t> checkpoint_step;
  std::chrono::steady_clock::time_point checkpoint_at;
};

// Thread-safe.
class RunControl {
 public:
  explicit RunControl(std::uint64_t epoch) : epoch_(epoch) {}

  // `at_end`: called by the worker in the transaction that ends the run, if the run comes to that; not at all when the
  // run was over already. Whoever commands waits for the run's end, or until `at_end` may be gone.
  using AtEnd = std::function<void(WriteTransaction& db)>;
  void command(RunCommand command, AtEnd at_end) {
    {
      const std::lock_guard lock(mutex_);
      at_end_.push_back(std::move(at_end));
    }
    this->command(command);
  }
  void command(RunCommand command) {
    RunCommand before = command_.load();
    while (before < command && !command_.compare_exchange_weak(before, command)) continue;
  }
  RunCommand command() const { return command_.load(std::memory_order_relaxed); }

  void publish(const MergeProgress& progress) {
    const std::lock_guard lock(mutex_);
    progress_ = progress;
  }
  // Nothing while the job is being loaded.
  std::optional<MergeProgress> progress() const {
    const std::lock_guard lock(mutex_);
    return progress_;
  }
  void tell_end(WriteTransaction& db) const {
    std::vector<AtEnd> at_end;
    {
      const std::lock_guard lock(mutex_);
      at_end = at_end_;
    }
    for (const AtEnd& tell : at_end) {
      try {
        tell(db);
      } catch (const StoreError&) {
        throw;
      } catch (const std::exception&) {
        // The run ends all the same; who commanded sees that nothing was written down.
      }
    }
  }
  std::uint64_t epoch() const { return epoch_; }

 private:
  const std::uint64_t epoch_;
  std::atomic<RunCommand> command_ = RunCommand::kNone;
  mutable std::mutex mutex_;
  std::optional<MergeProgress> progress_;
  std::vector<AtEnd> at_end_;
};

}  // namespace mapweld::server
