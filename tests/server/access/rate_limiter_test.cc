#include "server/access/rate_limiter.h"

#include <string>

#include <gtest/gtest.h>

namespace mapweld::server {
namespace {

constexpr Rate kTwoASecond{.per_s = 2, .burst = 4};

TEST(RateLimiter, ABucketIsSpentAndFillsAgain) {
  RateLimiter limiter;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(limiter.take("a", kTwoASecond, 10), 0);
  EXPECT_DOUBLE_EQ(limiter.take("a", kTwoASecond, 10), 0.5);
  EXPECT_DOUBLE_EQ(limiter.take("a", kTwoASecond, 10.25), 0.25);
  EXPECT_EQ(limiter.take("a", kTwoASecond, 10.5), 0);
  EXPECT_GT(limiter.take("a", kTwoASecond, 10.5), 0);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(limiter.take("a", kTwoASecond, 1000), 0);  // no more than a burst is saved up
  EXPECT_GT(limiter.take("a", kTwoASecond, 1000), 0);
}

TEST(RateLimiter, OverTimeTheRateIsMet) {
  RateLimiter limiter;
  int served = 0;
  for (int tick = 0; tick < 10'000; ++tick) served += limiter.take("a", kTwoASecond, tick * 0.01) == 0;  // 100 s
  EXPECT_NEAR(served, 4 + 2 * 100, 1);
}

TEST(RateLimiter, EachHasItsOwn) {
  RateLimiter limiter;
  for (int i = 0; i < 5; ++i) limiter.take("a", kTwoASecond, 0);
  EXPECT_EQ(limiter.take("b", kTwoASecond, 0), 0);
}

TEST(RateLimiter, NoRateIsNoLimit) {
  RateLimiter limiter;
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(limiter.take("a", {}, 0), 0);
}

TEST(RateLimiter, ManyNewcomersShareOneAndNobodyIsForgotten) {
  RateLimiter limiter(10);
  for (int i = 0; i < 4; ++i) limiter.take("a", kTwoASecond, 0);
  int served = 0;
  for (int i = 0; i < 1000; ++i) served += limiter.take("stranger " + std::to_string(i), kTwoASecond, 0) == 0;
  EXPECT_EQ(served, 9 + 4);  // nine buckets with a token taken, and the one that the others share
  EXPECT_GT(limiter.take("a", kTwoASecond, 0), 0);
  EXPECT_EQ(limiter.take("later", kTwoASecond, 100), 0);  // the buckets that are full again have made room
}

}  // namespace
}  // namespace mapweld::server
