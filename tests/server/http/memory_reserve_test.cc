#include "server/http/loop/memory_reserve.h"

#include <new>

#include <gtest/gtest.h>

namespace mapweld::server {
namespace {

// How often an operator new that finds no memory may try again.
int tries() {
  for (int count = 0; count < 1'000; ++count) {
    try {
      std::get_new_handler()();
    } catch (const std::bad_alloc&) {
      return count;
    }
  }
  return 1'000;
}

TEST(MemoryReserve, GivesWhatItHasAndThenNothing) {
  const std::new_handler before = std::get_new_handler();
  {
    const MemoryReserve first;
    const int all = tries();
    EXPECT_GT(all, 1);
    EXPECT_LT(all, 1'000);
    EXPECT_EQ(tries(), 0);
    MemoryReserve::refill();
    {
      const MemoryReserve second;  // the same
      EXPECT_EQ(tries(), all);
    }
    EXPECT_NE(std::get_new_handler(), before);
  }
  EXPECT_EQ(std::get_new_handler(), before);
}

}  // namespace
}  // namespace mapweld::server
