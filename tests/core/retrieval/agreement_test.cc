#include "core/retrieval/agreement.h"

#include <algorithm>
#include <bit>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

TEST(VoteSignature, HoldsTheChosenBitsOfASignature) {
  EXPECT_EQ(std::set(kVoteBits.begin(), kVoteBits.end()).size(), kVoteBits.size());
  EXPECT_TRUE(std::ranges::is_sorted(kVoteBits));
  std::mt19937 random(1);
  for (int round = 0; round < 500; ++round) {
    Signature signature;
    for (std::uint32_t& bits : signature.bits) bits = static_cast<std::uint32_t>(random());
    const VoteSignature chosen = vote_signature(signature);
    for (std::size_t k = 0; k < kVoteBits.size(); ++k) {
      const std::uint8_t bit = kVoteBits[k];
      EXPECT_EQ(chosen >> k & 1, signature.bits[bit / 32] >> bit % 32 & 1) << "bit " << int{bit};
    }
  }
}

TEST(VoteSignature, IsZeroOnlyWhereThereIsNoSignature) {
  EXPECT_EQ(vote_signature({}), 0u);
  for (std::uint32_t bit = 0; bit < 128; ++bit) {
    Signature one;
    one.bits[bit / 32] = 1u << bit % 32;
    EXPECT_NE(vote_signature(one), 0u);
  }
}

class AgreementKernels : public testing::TestWithParam<PopcountSimd> {};

TEST_P(AgreementKernels, FindWhatCountingBitsFinds) {
  std::mt19937_64 random(2);
  for (const std::size_t size : {0u, 1u, 3u, 4u, 7u, 8u, 9u, 63u, 64u, 65u, 200u, 1000u}) {
    const VoteSignature query = random() | 1;
    std::vector<VoteSignature> list;
    for (std::size_t k = 0; k < size; ++k) {
      VoteSignature signature = query;
      const int flips = static_cast<int>(random() % 24);
      for (int f = 0; f < flips; ++f) signature ^= VoteSignature{1} << random() % 64;
      list.push_back(random() % 20 == 0 ? 0 : signature);
    }
    std::vector<std::uint64_t> found(agreement_words(size) + 1, 0xABCDEF);
    for (const VoteSignature asked : {query, VoteSignature{0}}) {
      find_agreeing(asked, list, found.data(), GetParam());
      std::size_t agreeing = 0;
      for (std::size_t k = 0; k < size; ++k) {
        const bool expected = asked == 0 || list[k] == 0 || std::popcount(asked ^ list[k]) <= kVoteDistance;
        EXPECT_EQ(found[k / 64] >> k % 64 & 1, expected ? 1u : 0u) << k << " of " << size;
        EXPECT_EQ(agree(asked, list[k]), expected);
        agreeing += expected ? 1 : 0;
      }
      std::size_t set = 0;
      for (std::size_t w = 0; w < agreement_words(size); ++w) set += static_cast<std::size_t>(std::popcount(found[w]));
      EXPECT_EQ(set, agreeing);
      EXPECT_EQ(found.back(), 0xABCDEFu);
    }
  }
}

// On a processor without AVX2 or AVX-512 the limit gives a lesser kernel, which is then tested twice.
INSTANTIATE_TEST_SUITE_P(, AgreementKernels,
                         testing::Values(PopcountSimd::kScalar, PopcountSimd::kAvx2, PopcountSimd::kAvx512));

}  // namespace
}  // namespace mapweld
