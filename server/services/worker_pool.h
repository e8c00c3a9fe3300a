// Threads for work that keeps a core busy, shared fairly among requests.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace mapweld::server {

// Requests put their tasks into lanes. Workers take one task of each lane in turn, so that a single image does not wait
// behind a batch of sixty-four.
class WorkerPool {
 public:
  // `when_idle`: called on a worker once nothing has been to do for some seconds after work; must not throw.
  explicit WorkerPool(int threads, std::function<void()> when_idle = {});
  ~WorkerPool();  // all lanes must be closed
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return static_cast<int>(threads_.size()); }

  // The tasks of one request, begun in the order given. Used by one thread.
  class Lane {
   public:
    explicit Lane(WorkerPool& pool) : pool_(pool) {}
    // Forgets the tasks that have not begun and waits for those that have: they may use what the request owns.
    ~Lane();
    Lane(const Lane&) = delete;
    Lane& operator=(const Lane&) = delete;

    template <typename Function>
    std::future<std::invoke_result_t<Function>> submit(Function function) {
      auto task = std::make_shared<std::packaged_task<std::invoke_result_t<Function>()>>(std::move(function));
      auto future = task->get_future();
      push([task] { (*task)(); });
      return future;
    }

   private:
    friend class WorkerPool;
    void push(std::function<void()> task);

    WorkerPool& pool_;
    std::deque<std::function<void()>> tasks_;  // guarded by the pool's mutex, as is all that follows
    int running_ = 0;
    bool in_turn_ = false;
    std::condition_variable idle_;
  };

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Lane*> turns_;  // lanes with tasks
  const std::function<void()> when_idle_;
  int working_ = 0;
  bool worked_ = false;  // since when_idle_ was called
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace mapweld::server
