// A bound on the bodies that all requests together hold in memory.
#pragma once

#include <atomic>
#include <cstddef>

namespace mapweld::server {

// Thread-safe.
class BodyBudget {
 public:
  explicit BodyBudget(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // False, and nothing taken, when there is not so much left.
  bool take(std::size_t bytes) {
    if (used_bytes_.fetch_add(bytes) + bytes <= limit_bytes_) return true;
    used_bytes_.fetch_sub(bytes);
    return false;
  }
  void give_back(std::size_t bytes) { used_bytes_.fetch_sub(bytes); }

 private:
  const std::size_t limit_bytes_;
  std::atomic<std::size_t> used_bytes_{0};
};

}  // namespace mapweld::server
