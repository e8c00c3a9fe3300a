// The threads that work on requests, and how many may wait for one.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>  // missing in <boost/asio/awaitable.hpp> of 1.74

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace mapweld::server {

// Used by the thread of one event loop.
class RequestPool {
 public:
  RequestPool(int threads, std::size_t max_waiting)
      : threads_(static_cast<std::size_t>(threads)), most_(threads_ + max_waiting), pool_(threads_) {}

  std::size_t threads() const { return threads_; }
  // No more should be begun.
  bool is_full() const { return in_hand_ >= most_; }

  // Runs `work` on a thread of the pool; who awaits it goes on in the loop, with what it returned or threw.
  template <typename Result>
  boost::asio::awaitable<Result> run(std::function<Result()> work) {
    const Counted counted(in_hand_);
    co_return co_await boost::asio::co_spawn(pool_, call(std::move(work)), boost::asio::use_awaitable);
  }

  // After the loop has ended.
  void join() { pool_.join(); }

 private:
  struct Counted {
    explicit Counted(std::size_t& count) : count_(count) { ++count_; }
    ~Counted() { --count_; }
    Counted(const Counted&) = delete;
    std::size_t& count_;
  };

  template <typename Result>
  static boost::asio::awaitable<Result> call(std::function<Result()> work) {
    co_return work();
  }

  const std::size_t threads_;
  const std::size_t most_;
  std::size_t in_hand_ = 0;
  boost::asio::thread_pool pool_;
};

}  // namespace mapweld::server
