#include "server/http/connection_queue.h"

#include <utility>

namespace mapweld::server {
namespace {

thread_local bool is_turning_away = false;

}  // namespace

ConnectionQueue::ConnectionQueue(int threads, std::size_t max_waiting, std::atomic<int>& crowd)
    : max_waiting_(max_waiting), crowd_(crowd) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

void ConnectionQueue::enqueue(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    if (tasks_.size() < max_waiting_) {
      tasks_.push_back(std::move(task));
      ++crowd_;
      wake_.notify_one();
      return;
    }
  }
  is_turning_away = true;
  task();
  is_turning_away = false;
}

void ConnectionQueue::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool ConnectionQueue::turning_away() { return is_turning_away; }

void ConnectionQueue::work() {
  while (true) {
    std::function<void()> task;
    {
      std::unique_lock lock(mutex_);
      --crowd_;
      wake_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
      if (tasks_.empty()) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    task();
  }
}

}  // namespace mapweld::server
