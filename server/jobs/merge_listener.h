// Who is told what merges do while they do it.
#pragma once

#include <cstdint>

#include "schema/store_types.h"
#include "server/jobs/merge_status.h"
#include "server/jobs/run_control.h"

namespace mapweld::server {

// Called by the threads that do it, several at once, which wait meanwhile: it must return soon and not throw.
class MergeListener {
 public:
  virtual ~MergeListener() = default;

  // A run has inserted an edge, in this step. One that a guard is still to judge is not confirmed yet.
  virtual void on_edge(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept = 0;
  // A guard has confirmed an edge, or taken that back.
  virtual void on_verdict(JobId job, std::uint64_t step, const MergeEdgePoint& edge) noexcept = 0;
  // A run's numbers have moved; several times a second at least.
  virtual void on_progress(JobId job, const MergeProgress& progress) noexcept = 0;
  // The job may have another state; it is in the store.
  virtual void on_state(JobId job) noexcept = 0;
};

}  // namespace mapweld::server
