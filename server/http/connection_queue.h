// The threads that serve connections, and the queue before them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include <httplib.h>

namespace mapweld::server {

// A fixed number of threads and a bounded queue, in place of the library's unbounded one.
class ConnectionQueue final : public httplib::TaskQueue {
 public:
  // `crowd` is kept at: connections that wait, less threads that do. It must outlive this.
  ConnectionQueue(int threads, std::size_t max_waiting, std::atomic<int>& crowd);

  // When the queue is full, runs the task at once on the calling thread, with turning_away() true.
  void enqueue(std::function<void()> task) override;
  // Finishes what is queued, then joins the threads.
  void shutdown() override;

  // Whether the task that this thread runs is a connection to be turned away.
  static bool turning_away();

 private:
  void work();

  const std::size_t max_waiting_;
  std::atomic<int>& crowd_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> tasks_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace mapweld::server
