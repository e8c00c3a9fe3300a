#include "server/services/worker_pool.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace mapweld::server {

namespace {
constexpr std::chrono::seconds kIdleAfter{2};
}

WorkerPool::WorkerPool(int threads, std::function<void()> when_idle) : when_idle_(std::move(when_idle)) {
  for (int i = 0; i < std::max(threads, 1); ++i) threads_.emplace_back([this] { work(); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::work() {
  std::unique_lock lock(mutex_);
  const auto something_to_do = [this] { return stopping_ || !turns_.empty(); };
  while (true) {
    if (when_idle_ && worked_ && working_ == 0) {
      if (!wake_.wait_for(lock, kIdleAfter, something_to_do)) {
        if (working_ > 0 || !std::exchange(worked_, false)) continue;
        lock.unlock();
        when_idle_();
        lock.lock();
        continue;
      }
    } else {
      wake_.wait(lock, something_to_do);
    }
    if (turns_.empty()) {
      if (stopping_) return;
      continue;
    }
    Lane* const lane = turns_.front();
    turns_.pop_front();
    std::function<void()> task = std::move(lane->tasks_.front());
    lane->tasks_.pop_front();
    lane->in_turn_ = !lane->tasks_.empty();
    if (lane->in_turn_) turns_.push_back(lane);
    ++lane->running_;
    ++working_;
    worked_ = true;
    lock.unlock();
    task();
    task = nullptr;  // before the lane may go: the task holds what the request owns
    lock.lock();
    --working_;
    if (--lane->running_ == 0) lane->idle_.notify_all();
  }
}

void WorkerPool::Lane::push(std::function<void()> task) {
  const std::lock_guard lock(pool_.mutex_);
  tasks_.push_back(std::move(task));
  if (!in_turn_) {
    in_turn_ = true;
    pool_.turns_.push_back(this);
  }
  pool_.wake_.notify_one();
}

WorkerPool::Lane::~Lane() {
  std::unique_lock lock(pool_.mutex_);
  if (in_turn_) std::erase(pool_.turns_, this);
  tasks_.clear();
  idle_.wait(lock, [this] { return running_ == 0; });
}

}  // namespace mapweld::server
