// A bound on the bodies that all requests together hold in memory.
#pragma once

#include <atomic>
#include <cstddef>
#include <utility>

namespace mapweld::server {

// Thread-safe.
class BodyBudget {
 public:
  explicit BodyBudget(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // What one body has taken; given back at the end of its life. Used by one thread at a time.
  class Share {
   public:
    explicit Share(BodyBudget& budget) : budget_(&budget) {}
    Share(Share&& other) noexcept : budget_(other.budget_), bytes_(std::exchange(other.bytes_, 0)) {}
    Share& operator=(Share&&) = delete;
    ~Share() { budget_->used_bytes_ -= bytes_; }

    // False, and nothing taken, when there is not so much left.
    bool take(std::size_t bytes) {
      if (budget_->used_bytes_.fetch_add(bytes) + bytes > budget_->limit_bytes_) {
        budget_->used_bytes_ -= bytes;
        return false;
      }
      bytes_ += bytes;
      return true;
    }

   private:
    BodyBudget* budget_;
    std::size_t bytes_ = 0;
  };

 private:
  const std::size_t limit_bytes_;
  std::atomic<std::size_t> used_bytes_{0};
};

}  // namespace mapweld::server
