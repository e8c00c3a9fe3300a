// Nearest neighbours among two images' signatures: every distance of one list to the other, in one pass.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/processor.h"
#include "core/types.h"

namespace mapweld {

// Number of bits in which two signatures differ, 0..128.
int hamming_distance(const Signature& a, const Signature& b);

// One signature's nearest in the other list.
inline constexpr std::uint32_t kNoDistance = 0xFFFF;
struct NearestSignature {
  std::uint32_t index = 0;                // of several that are equally near, the first
  std::uint32_t distance = kNoDistance;   // in bits; kNoDistance: it was compared with nobody
  std::uint32_t runner_up = kNoDistance;  // distance of the second nearest; kNoDistance: there was but one
  friend bool operator==(const NearestSignature&, const NearestSignature&) = default;
};

struct NearestSignatures {
  std::vector<NearestSignature> of_a;  // for each of a, among those of b that it was compared with
  std::vector<NearestSignature> of_b;  // and the other way round
};

// Which of b one of a is compared with: first .. first + count - 1, going on at 0 after the last; count at most b's
// size.
struct Compared {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

// Exact: 0.25 (AVX-512), 0.54 (AVX2) or 8 ns a comparison. Lists of at most 65535 signatures. `compared`: one for each
// of a. `limit`: the widest instruction set that is used.
NearestSignatures nearest_signatures(std::span<const Signature> a, std::span<const Signature> b,
                                     std::span<const Compared> compared, PopcountSimd limit = PopcountSimd::kAvx512);

}  // namespace mapweld
