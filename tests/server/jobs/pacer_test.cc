#include "server/jobs/pacer.h"

#include <gtest/gtest.h>

namespace mapweld::server {
namespace {

TEST(Pacer, KeepsTheIntervalWhenTheWorkIsCheap) {
  Pacer pacer(0.5, 0.1);
  EXPECT_TRUE(pacer.due(0));
  pacer.done(1.0, 1.01);
  EXPECT_FALSE(pacer.due(1.5));
  EXPECT_TRUE(pacer.due(1.52));
}

TEST(Pacer, WaitsLongerAfterWorkThatTookLong) {
  Pacer pacer(0.5, 0.1);
  pacer.done(1.0, 1.2);  // 0.2 s: ten times as long until the next
  EXPECT_FALSE(pacer.due(3.1));
  EXPECT_TRUE(pacer.due(3.21));
}

// Whatever each piece of work costs, together they take no more than their share.
TEST(Pacer, KeepsTheShare) {
  Pacer pacer(0.05, 0.1);
  double now_s = 0, spent_s = 0;
  while (now_s < 100) {
    if (!pacer.due(now_s)) {
      now_s += 0.001;
      continue;
    }
    const double cost_s = 0.002 + 0.1 * (static_cast<int>(now_s) % 5);
    pacer.done(now_s, now_s + cost_s);
    now_s += cost_s;
    spent_s += cost_s;
  }
  EXPECT_LE(spent_s / now_s, 0.1);
  EXPECT_GT(spent_s / now_s, 0.05);
}

TEST(Pacer, CanBePutOff) {
  Pacer pacer(0.5, 0.1);
  pacer.put_off(2);
  EXPECT_FALSE(pacer.due(2.4));
  EXPECT_TRUE(pacer.due(2.5));
}

}  // namespace
}  // namespace mapweld::server
