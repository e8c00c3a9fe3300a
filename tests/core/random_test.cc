#include "core/random.h"

#include <array>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

// Vigna's splitmix64.c from seed 0. Vocabularies, samples and merges are drawn by these numbers.
TEST(SplitMix64, IsThePublishedSequence) {
  SplitMix64 random(0);
  std::uint64_t state = 0;
  for (const std::uint64_t expected : {0xE220A8397B1DCDAFull, 0x6E789E6AA1B965F4ull, 0x06C45D188009454Full}) {
    EXPECT_EQ(random.next(), expected);
    EXPECT_EQ(next_random(state), expected);
  }
}

TEST(SplitMix64, DrawsBelowABoundArePinned) {
  SplitMix64 random(42), half(42);
  for (const std::uint32_t expected : {741u, 159u, 278u, 344u, 38u, 868u}) {
    EXPECT_EQ(random.below(1000), expected);
    EXPECT_EQ(half.below32(1000), expected);
  }
}

TEST(SplitMix64, DrawsBelowABoundAreUniform) {
  SplitMix64 random(42), half(43);
  std::array<int, 6> counts{}, half_counts{};
  for (int i = 0; i < 60000; ++i) {
    ++counts.at(random.below(6));
    ++half_counts.at(half.below32(6));
  }
  for (std::size_t value = 0; value < counts.size(); ++value) {
    EXPECT_NEAR(counts[value], 10000, 500) << value;
    EXPECT_NEAR(half_counts[value], 10000, 500) << value;
  }
}

}  // namespace
}  // namespace mapweld
