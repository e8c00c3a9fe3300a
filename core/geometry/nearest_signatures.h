// Nearest neighbours among two images' signatures: every distance of one list to the other, in one pass.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/processor.h"
#include "core/types.h"

namespace mapweld {

// Number of bits in which two signatures differ, 0..128.
int hamming_distance(const Signature& a, const Signature& b);

// One signature's nearest in the other list, of those within a bound.
inline constexpr std::uint32_t kNoDistance = 0xFFFF;
struct NearestSignature {
  std::uint32_t index = 0;                // of several that are equally near, the first
  std::uint32_t distance = kNoDistance;   // in bits; kNoDistance: there is none
  std::uint32_t runner_up = kNoDistance;  // distance of the second nearest; kNoDistance: there is but one
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

// Signatures laid out so that one is compared with 32 of them at a time, four bits after four bits. At most 65535.
class SignatureBlocks {
 public:
  static constexpr std::size_t kLanes = 32;
  struct alignas(kLanes) Block {
    std::array<std::array<std::uint8_t, kLanes>, 32> nibbles{};  // by place in the signature, of each
  };

  explicit SignatureBlocks(std::span<const Signature> signatures);
  std::size_t size() const { return size_; }
  const Block* blocks() const { return blocks_.data(); }

 private:
  std::size_t size_;
  std::vector<Block> blocks_;
};

// Neighbours at most `within` bits apart, 0..127; those further away are as if they were not there. Exact. `compared`:
// one for each of a, of which there are at most 65535. `limit`: the widest instruction set that is used, of the scalar
// one and AVX2: 2.3 or 0.25 ns a comparison.
NearestSignatures nearest_signatures(std::span<const Signature> a, const SignatureBlocks& b,
                                     std::span<const Compared> compared, std::uint8_t within,
                                     PopcountSimd limit = PopcountSimd::kAvx2);

}  // namespace mapweld
