// Verifying pairs on all cores: core's Executor over a pool of threads.
#pragma once

#include <memory>

#include "core/merge/executor.h"
#include "server/services/worker_pool.h"

namespace mapweld::server {

// The calling thread works along with those of the pool, so that a run gets on also when others keep the pool busy.
class PoolExecutor final : public Executor {
 public:
  // `pool` must outlive this.
  explicit PoolExecutor(WorkerPool& pool) : pool_(pool) {}

  std::size_t concurrency() const override { return static_cast<std::size_t>(pool_.threads()) + 1; }
  void run(std::size_t pieces, const std::function<void(std::size_t)>& piece) const override;
  std::unique_ptr<TaskLine> open_line() const override;

 private:
  WorkerPool& pool_;
};

}  // namespace mapweld::server
