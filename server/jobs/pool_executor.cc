#include "server/jobs/pool_executor.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace mapweld::server {
namespace {

class PoolLine final : public TaskLine {
 public:
  explicit PoolLine(WorkerPool& pool) : lane_(pool) {}
  void submit(std::function<void()> task) override { lane_.submit(std::move(task)); }

 private:
  WorkerPool::Lane lane_;
};

}  // namespace

void PoolExecutor::run(std::size_t pieces, const std::function<void(std::size_t)>& piece) const {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < pieces; i = next++) piece(i);
  };
  WorkerPool::Lane lane(pool_);
  const std::size_t helpers =
      std::min<std::size_t>(static_cast<std::size_t>(pool_.threads()), pieces - std::min<std::size_t>(pieces, 1));
  for (std::size_t i = 0; i < helpers; ++i) lane.submit(work);
  work();
  // The lane's end waits for the helpers that have begun; `next` tells the others that nothing is left.
}

std::unique_ptr<TaskLine> PoolExecutor::open_line() const { return std::make_unique<PoolLine>(pool_); }

}  // namespace mapweld::server
