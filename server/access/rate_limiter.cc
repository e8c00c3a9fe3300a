#include "server/access/rate_limiter.h"

#include <algorithm>

namespace mapweld::server {
namespace {

constexpr double kSweepEvery_s = 1;  // a sweep looks at every bucket

}  // namespace

double RateLimiter::Bucket::tokens_at(double now_s) const {
  return std::min(rate.burst, tokens + std::max(0.0, now_s - at_s) * rate.per_s);
}

RateLimiter::Bucket& RateLimiter::bucket_of(const std::string& who, const Rate& rate, double now_s) {
  if (const auto known = buckets_.find(who); known != buckets_.end()) return known->second;
  if (buckets_.size() >= max_buckets_ && now_s >= next_sweep_s_) {
    std::erase_if(buckets_, [&](const auto& item) { return item.second.tokens_at(now_s) >= item.second.rate.burst; });
    next_sweep_s_ = now_s + kSweepEvery_s;
  }
  const std::string& name = buckets_.size() < max_buckets_ ? who : std::string();
  return buckets_.try_emplace(name, Bucket{.tokens = rate.burst, .at_s = now_s, .rate = rate}).first->second;
}

double RateLimiter::take(const std::string& who, const Rate& rate, double now_s) {
  if (rate.per_s <= 0) return 0;
  const std::lock_guard lock(mutex_);
  Bucket& bucket = bucket_of(who, rate, now_s);
  bucket.tokens = bucket.tokens_at(now_s);
  bucket.at_s = std::max(bucket.at_s, now_s);
  if (bucket.tokens < 1) return (1 - bucket.tokens) / bucket.rate.per_s;
  bucket.tokens -= 1;
  return 0;
}

}  // namespace mapweld::server
