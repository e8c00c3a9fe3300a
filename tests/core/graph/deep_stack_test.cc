#include "core/graph/deep_stack.h"

#include <stdexcept>
#include <system_error>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

// Some 1,000 bytes of stack each time, which the compiler cannot do without.
int depth_reached(int depth) {
  volatile char frame[1000];
  frame[static_cast<std::size_t>(depth) % sizeof frame] = 1;
  if (depth == 0) return frame[0];
  return depth_reached(depth - 1) + frame[static_cast<std::size_t>(depth) % sizeof frame];
}

TEST(DeepStack, ReachesDeeperThanAUsualStack) {
  int reached = 0;
  run_on_stack(std::size_t{256} << 20, [&] { reached = depth_reached(40000); });  // 40 MB, and more under sanitizers
  EXPECT_EQ(reached, 40001);
}

TEST(DeepStack, ThrowsWhatTheWorkThrows) {
  EXPECT_THROW(run_on_stack(1 << 20, [] { throw std::runtime_error("no"); }), std::runtime_error);
  bool has_begun = false;
  EXPECT_THROW(run_on_stack(1, [&] { has_begun = true; }), std::system_error) << "less than a thread can have";
  EXPECT_FALSE(has_begun);
}

}  // namespace
}  // namespace mapweld
