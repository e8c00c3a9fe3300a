#include "core/merge/spectral/largest_first.h"

#include <cstdint>
#include <queue>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

TEST(LargestFirst, GivesWhatOneHeapGives) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> items(seed * 100);
    for (std::uint32_t& item : items) item = static_cast<std::uint32_t>(random()) % 5000;
    std::priority_queue<std::uint32_t> heap(items.begin(), items.end());
    LargestFirst<std::uint32_t> queue(items, seed % 4);
    while (!heap.empty()) {
      ASSERT_EQ(queue.front(), heap.top());
      ASSERT_EQ(queue.pop(), heap.top());
      const std::uint32_t item = heap.top();
      heap.pop();
      if (item == 0 || random() % 3 != 0) continue;
      const std::uint32_t smaller = static_cast<std::uint32_t>(random()) % item;
      heap.push(smaller);
      queue.push(smaller);
    }
    EXPECT_TRUE(queue.empty());
  }
}

}  // namespace
}  // namespace mapweld
