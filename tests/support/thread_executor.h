// Four threads for core's Executor, whatever the machine has.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/merge/executor.h"

namespace mapweld::test {

class ThreadExecutor final : public Executor {
 public:
  std::size_t concurrency() const override { return kThreads; }
  void run(std::size_t pieces, const std::function<void(std::size_t)>& piece) const override {
    std::atomic<std::size_t> next = 0;
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < std::min(kThreads, pieces); ++t) {
      threads.emplace_back([&] {
        for (std::size_t i = next++; i < pieces; i = next++) piece(i);
      });
    }
    for (std::thread& thread : threads) thread.join();
    pieces_ += pieces;
  }
  std::unique_ptr<TaskLine> open_line() const override { return std::make_unique<Line>(tasks_); }

  // Given to it so far.
  std::size_t tasks() const { return tasks_; }
  std::size_t pieces() const { return pieces_; }

 private:
  static constexpr std::size_t kThreads = 4;  // the caller's too

  class Line final : public TaskLine {
   public:
    explicit Line(std::atomic<std::size_t>& tasks) : tasks_(tasks) {
      for (std::size_t t = 1; t < kThreads; ++t) threads_.emplace_back([this] { work(); });
    }
    ~Line() override {
      {
        const std::lock_guard lock(mutex_);
        line_.clear();
        is_closed_ = true;
      }
      wake_.notify_all();
      for (std::thread& thread : threads_) thread.join();
    }
    void submit(std::function<void()> task) override {
      ++tasks_;
      const std::lock_guard lock(mutex_);
      line_.push_back(std::move(task));
      wake_.notify_one();
    }

   private:
    void work() {
      std::unique_lock lock(mutex_);
      for (;;) {
        wake_.wait(lock, [this] { return is_closed_ || !line_.empty(); });
        if (line_.empty()) return;
        const std::function<void()> task = std::move(line_.front());
        line_.pop_front();
        lock.unlock();
        task();
        lock.lock();
      }
    }

    std::atomic<std::size_t>& tasks_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::function<void()>> line_;
    bool is_closed_ = false;
    std::vector<std::thread> threads_;
  };

  mutable std::atomic<std::size_t> tasks_ = 0, pieces_ = 0;
};

}  // namespace mapweld::test
