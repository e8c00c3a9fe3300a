// The part of a signature that votes go by, and when two of them agree (Jegou, Douze & Schmid, "Hamming embedding and
// weak geometric consistency for large scale image search", ECCV 2008).
#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace mapweld {

// The bits of a signature that tell features of one word apart best, ascending: 64 of the 128, so that a posting takes
// 12 bytes. Chosen once by tests/benchmark/signature_bits.cc from photographs of `vocabulary/houses` and
// `vocabulary/doordetect`, none of them of a place that anything is tested on (docs/votes.md).
// Stored segments hold these bits: another choice is another version of their format.
extern const std::array<std::uint8_t, 64> kVoteBits;

// Zero: the feature has no signature, as those of images stored by early versions.
using VoteSignature = std::uint64_t;

// The bits kVoteBits of a signature, in this order; one of them is set where a known signature has none.
VoteSignature vote_signature(const Signature& signature);

// Two features of one word agree when their signatures differ in at most so many bits, or one has none.
inline constexpr int kVoteDistance = 13;
inline bool agree(VoteSignature a, VoteSignature b) {
  // Without an instruction for it std::popcount looks tables up; this is a dozen operations.
  VoteSignature bits = a ^ b;
  bits -= bits >> 1 & 0x5555555555555555;
  bits = (bits & 0x3333333333333333) + (bits >> 2 & 0x3333333333333333);
  const auto distance = static_cast<int>(((bits + (bits >> 4)) & 0x0F0F0F0F0F0F0F0F) * 0x0101010101010101 >> 56);
  return a == 0 || b == 0 || distance <= kVoteDistance;
}

}  // namespace mapweld
