// How often somebody may ask: a token bucket for each key and each address.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

namespace mapweld::server {

struct Rate {
  double per_s = 0;  // tokens that come back a second; 0: no limit
  double burst = 1;  // tokens that a bucket holds
};

// Thread-safe. Times are seconds of any clock that does not run backwards.
class RateLimiter {
 public:
  // Remembers at most `max_buckets`; buckets that are full again go first, and when none is, newcomers share one.
  explicit RateLimiter(std::size_t max_buckets = 16'384) : max_buckets_(max_buckets) {}

  // Takes a token from the bucket of `who`. 0: there was one; else in how many seconds there will be one.
  double take(const std::string& who, const Rate& rate, double now_s);

 private:
  struct Bucket {
    double tokens = 0;
    double at_s = 0;
    Rate rate;
    double tokens_at(double now_s) const;
  };
  Bucket& bucket_of(const std::string& who, const Rate& rate, double now_s);

  const std::size_t max_buckets_;
  std::mutex mutex_;
  std::unordered_map<std::string, Bucket> buckets_;
  double next_sweep_s_ = 0;
};

}  // namespace mapweld::server
