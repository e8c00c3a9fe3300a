#include "core/vocabulary/signature.h"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"

namespace mapweld {
namespace {

using Descriptor = std::array<std::uint8_t, kDescriptorDimension>;

Descriptor random_descriptor(SplitMix64& random, std::uint32_t values) {
  Descriptor descriptor;
  for (auto& component : descriptor) component = static_cast<std::uint8_t>(random.below(values));
  return descriptor;
}

bool bit(const Signature& signature, std::size_t i) { return (signature.bits[i / 32] >> i % 32 & 1) != 0; }

TEST(Signature, SaysWhatIsGreaterThanTheMedian) {
  SplitMix64 random(7);
  for (const std::uint32_t values : {2u, 3u, 10u, 256u}) {
    for (int i = 0; i < 500; ++i) {
      const Descriptor descriptor = random_descriptor(random, values);
      Descriptor sorted = descriptor;
      std::ranges::sort(sorted);
      const Signature signature = signature_of(descriptor);
      if (sorted.front() == sorted.back() || sorted[64] == sorted.back()) continue;  // nothing is greater: below
      for (std::size_t k = 0; k < descriptor.size(); ++k) ASSERT_EQ(bit(signature, k), descriptor[k] > sorted[64]);
    }
  }
}

TEST(Signature, IsNeverZero) {
  for (const int value : {0, 1, 254, 255}) {
    Descriptor descriptor;
    descriptor.fill(static_cast<std::uint8_t>(value));
    EXPECT_NE(signature_of(descriptor), Signature{}) << value;
  }
}

TEST(Signature, ChangesLittleWhenTheDescriptorDoes) {
  SplitMix64 random(8);
  int near = 0;
  int far = 0;
  for (int i = 0; i < 200; ++i) {
    const Descriptor descriptor = random_descriptor(random, 160);
    Descriptor moved = descriptor;
    for (auto& component : moved) component = static_cast<std::uint8_t>(component + random.below(16));
    const Signature s = signature_of(descriptor), t = signature_of(moved);
    const Signature u = signature_of(random_descriptor(random, 160));
    for (std::size_t k = 0; k < 4; ++k) {
      near += std::popcount(s.bits[k] ^ t.bits[k]);
      far += std::popcount(s.bits[k] ^ u.bits[k]);
    }
  }
  EXPECT_LT(near / 200.0, 12);
  EXPECT_NEAR(far / 200.0, 64, 4) << "of unrelated ones half the bits differ";
}

}  // namespace
}  // namespace mapweld
