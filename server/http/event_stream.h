// A reply without an end: text that comes from any thread while the client listens (server-sent events).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace mapweld::server {

// Between those who have something to tell and the loop that writes it. Thread-safe; nobody waits.
class EventStream {
 public:
  // Of what waits to be written; whoever reads more slowly is given up, and may ask again for what was missed.
  explicit EventStream(std::size_t max_waiting_bytes = 1024 * 1024) : max_waiting_bytes_(max_waiting_bytes) {}

  // What is written first, however much it is; before anything else.
  void start(std::string text) {
    const std::lock_guard lock(mutex_);
    first_ = std::move(text);
  }

  // False: nobody listens any more.
  bool push(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (ended_) return false;
    const bool was_told = !waiting_.empty();
    if (waiting_.size() + text.size() > max_waiting_bytes_) {
      ended_ = true;  // the writer is awake already: something waits
      waiting_ = std::string();
    } else {
      waiting_ += text;
    }
    if (wake_ && !was_told) wake_();
    return !ended_;
  }

  // Ends the stream once what waits is written; from then on push() is false.
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    if (wake_) wake_();
  }

  // For the one who writes: what waits, which may be nothing.
  struct Taken {
    std::string text;
    bool ended = false;  // nothing follows
  };
  Taken take() {
    const std::lock_guard lock(mutex_);
    return {std::exchange(first_, {}) + std::exchange(waiting_, {}), ended_};
  }
  // `wake` is called, by any thread and briefly, when there is something to take again; an empty one ends that.
  void set_wake(std::function<void()> wake) {
    const std::lock_guard lock(mutex_);
    wake_ = std::move(wake);
  }

 private:
  const std::size_t max_waiting_bytes_;
  std::mutex mutex_;
  std::string first_;
  std::string waiting_;
  bool ended_ = false;
  std::function<void()> wake_;
};

}  // namespace mapweld::server
