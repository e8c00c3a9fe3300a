#include "core/merge/methods/random_order.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

std::vector<std::uint64_t> values(const RandomOrder& order) {
  std::vector<std::uint64_t> result;
  for (std::uint64_t i = 0; i < order.size(); ++i) result.push_back(order.at(i));
  return result;
}

TEST(RandomOrder, HasEveryNumberOnce) {
  for (const std::uint64_t n : {1, 2, 3, 5, 16, 17, 100, 1023, 1024, 1025, 20000}) {
    for (std::uint64_t key = 0; key < 5; ++key) {
      std::vector<std::uint64_t> seen = values(RandomOrder(n, key));
      std::ranges::sort(seen);
      std::vector<std::uint64_t> all(n);
      std::iota(all.begin(), all.end(), 0);
      EXPECT_EQ(seen, all) << n << " by key " << key;
    }
  }
  EXPECT_EQ(RandomOrder(0, 7).size(), 0u);
}

TEST(RandomOrder, AnotherKeyIsAnotherOrder) {
  EXPECT_EQ(values(RandomOrder(1000, 3)), values(RandomOrder(1000, 3)));
  EXPECT_NE(values(RandomOrder(1000, 3)), values(RandomOrder(1000, 4)));
}

// Where each number stands, over many keys: uniform by a chi-squared test of ten places for ten numbers.
TEST(RandomOrder, PutsEveryNumberEverywhereAlike) {
  constexpr int kKeys = 20000, kNumbers = 10;
  std::vector<int> count(kNumbers * kNumbers, 0);
  for (int key = 0; key < kKeys; ++key) {
    const RandomOrder order(kNumbers, static_cast<std::uint64_t>(key) * 977);
    for (int i = 0; i < kNumbers; ++i) ++count[i * kNumbers + static_cast<int>(order.at(i))];
  }
  const double expected = static_cast<double>(kKeys) / kNumbers;
  double chi_squared = 0;
  for (const int c : count) chi_squared += (c - expected) * (c - expected) / expected;
  EXPECT_LT(chi_squared, 140);  // 81 degrees of freedom: 125 is the 99.9th percentile
}

}  // namespace
}  // namespace mapweld
