#include "core/geometry/nearest_signatures.h"

#include <algorithm>
#include <bit>

#include "core/popcount_kernels.h"

namespace mapweld {
namespace {

using Block = SignatureBlocks::Block;
constexpr std::size_t kLanes = SignatureBlocks::kLanes;
constexpr std::size_t kNibbles = 32;  // of a signature

using Nibbles = std::array<std::uint8_t, kNibbles>;

// In an order that is soon found: the lower halves of its bytes, then the upper ones.
Nibbles nibbles_of(const Signature& signature) {
  const auto bytes = std::bit_cast<std::array<std::uint8_t, kNibbles / 2>>(signature.bits);
  Nibbles nibbles;
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    nibbles[k] = bytes[k] & 15;
    nibbles[bytes.size() + k] = bytes[k] >> 4;
  }
  return nibbles;
}

// What one signature is to those of a block: bit k of `near` when the k-th is within the bound, and how far each is.
struct alignas(kLanes) Distances {
  std::array<std::uint8_t, kLanes> of{};
  std::uint32_t near = 0;
};

// Compares `row` with each of `count` blocks.
using Kernel = void (*)(const Nibbles& row, const Block* blocks, std::size_t count, std::uint8_t within,
                        Distances* distances);

void compare_scalar(const Nibbles& row, const Block* blocks, std::size_t count, std::uint8_t within,
                    Distances* distances) {
  for (std::size_t k = 0; k < count; ++k) {
    std::array<std::uint8_t, kLanes> sum{};
    for (std::size_t n = 0; n < kNibbles; ++n) {
      const std::uint8_t own = row[n];
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        auto x = static_cast<std::uint8_t>(blocks[k].nibbles[n][lane] ^ own);
        x = static_cast<std::uint8_t>(x - (x >> 1 & 5));  // set bits of each two of four
        sum[lane] = static_cast<std::uint8_t>(sum[lane] + (x & 3) + (x >> 2));
      }
    }
    distances[k] = {sum, 0};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      distances[k].near |= std::uint32_t{sum[lane] <= within} << lane;
    }
  }
}

#ifdef MAPWELD_X86_KERNELS

// By nibble of the one signature: how far it is from each of the sixteen that the other may have there. Twice.
struct alignas(32) NibbleDistances {
  std::array<std::uint8_t, 32> to;
};
constexpr std::array<NibbleDistances, 16> kNibbleDistances = [] {
  std::array<NibbleDistances, 16> tables{};
  for (unsigned own = 0; own < 16; ++own) {
    for (unsigned k = 0; k < 32; ++k) tables[own].to[k] = static_cast<std::uint8_t>(std::popcount(own ^ k % 16));
  }
  return tables;
}();

// So many blocks at once, because each nibble's table serves them all.
template <std::size_t kBlocks>
MAPWELD_AVX2 inline void compare_some_avx2(const Nibbles& row, const Block* blocks, std::uint8_t within,
                                           Distances* distances) {
  __m256i sum[kBlocks];
  for (std::size_t k = 0; k < kBlocks; ++k) sum[k] = _mm256_setzero_si256();
#pragma GCC unroll 8
  for (std::size_t n = 0; n < kNibbles; ++n) {
    const __m256i table = _mm256_load_si256(reinterpret_cast<const __m256i*>(kNibbleDistances[row[n]].to.data()));
    for (std::size_t k = 0; k < kBlocks; ++k) {
      const __m256i theirs = _mm256_load_si256(reinterpret_cast<const __m256i*>(blocks[k].nibbles[n].data()));
      sum[k] = _mm256_add_epi8(sum[k], _mm256_shuffle_epi8(table, theirs));
    }
  }
  const __m256i most = _mm256_set1_epi8(static_cast<char>(within));
  for (std::size_t k = 0; k < kBlocks; ++k) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(distances[k].of.data()), sum[k]);
    distances[k].near =
        static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_min_epu8(sum[k], most), sum[k])));
  }
}

MAPWELD_AVX2 void compare_avx2(const Nibbles& row, const Block* blocks, std::size_t count, std::uint8_t within,
                               Distances* distances) {
  for (; count >= 4; count -= 4, blocks += 4, distances += 4) compare_some_avx2<4>(row, blocks, within, distances);
  if (count == 3) compare_some_avx2<3>(row, blocks, within, distances);
  if (count == 2) compare_some_avx2<2>(row, blocks, within, distances);
  if (count == 1) compare_some_avx2<1>(row, blocks, within, distances);
}

// More than AVX2 is of no use: where signatures lie in memory is what it waits for.
constexpr PopcountKernels<Kernel> kKernels{compare_scalar, compare_avx2, compare_avx2};
#else
constexpr PopcountKernels<Kernel> kKernels{compare_scalar};
#endif

// A neighbour as one number, distance above, index below: the least is the nearest, and the first of several.
constexpr std::uint32_t kNobody = 0xFFFFFFFF;
constexpr std::uint32_t key(std::uint32_t distance, std::uint32_t index) { return distance << 16 | index; }

struct Nearest {
  std::uint32_t best = kNobody;
  std::uint32_t second = kNobody;

  void offer(std::uint32_t offered) {
    second = std::min(second, std::max(best, offered));
    best = std::min(best, offered);
  }
  NearestSignature told() const {
    if (best == kNobody) return {};
    return {best & 0xFFFF, best >> 16, second == kNobody ? kNoDistance : second >> 16};
  }
};

// One pass over the signatures of a.
class Pass {
 public:
  Pass(const SignatureBlocks& b, std::uint8_t within, PopcountSimd limit)
      : b_(b), within_(within), compare_(kKernels.widest(limit)), distances_(b.size() / kLanes + 1), of_b_(b.size()) {}

  // The nearest of `row`, the i-th, and what it is to the others.
  NearestSignature nearest_of(const Signature& row, std::uint32_t i, const Compared& compared) {
    Nearest own;
    const std::size_t end = std::size_t{compared.first} + compared.count;
    const Nibbles nibbles = nibbles_of(row);
    compare(nibbles, i, compared.first, std::min(end, b_.size()), own);
    if (end > b_.size()) compare(nibbles, i, 0, end - b_.size(), own);
    return own.told();
  }
  std::vector<NearestSignature> nearest_of_b() const {
    std::vector<NearestSignature> told;
    told.reserve(of_b_.size());
    for (const Nearest& nearest : of_b_) told.push_back(nearest.told());
    return told;
  }

 private:
  void compare(const Nibbles& row, std::uint32_t i, std::size_t from, std::size_t to, Nearest& own) {
    if (from >= to) return;
    const std::size_t first = from / kLanes, last = (to - 1) / kLanes;
    compare_(row, b_.blocks() + first, last - first + 1, within_, distances_.data());
    distances_[0].near &= ~std::uint32_t{0} << from % kLanes;
    distances_[last - first].near &= ~std::uint32_t{0} >> (kLanes - 1 - (to - 1) % kLanes);
    for (std::size_t block = first; block <= last; ++block) {
      const Distances& found = distances_[block - first];
      for (std::uint32_t near = found.near; near != 0; near &= near - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(near));
        const std::size_t j = block * kLanes + lane;
        own.offer(key(found.of[lane], static_cast<std::uint32_t>(j)));
        of_b_[j].offer(key(found.of[lane], i));
      }
    }
  }

  const SignatureBlocks& b_;
  std::uint8_t within_;
  Kernel compare_;
  std::vector<Distances> distances_;  // of one row
  std::vector<Nearest> of_b_;
};

// Without an instruction for it std::popcount looks tables up; this is a dozen operations for 64 bits.
constexpr std::uint64_t set_bits(std::uint64_t word) {
  word -= word >> 1 & 0x5555555555555555;
  word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
  return ((word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F) * 0x0101010101010101 >> 56;
}

}  // namespace

int hamming_distance(const Signature& a, const Signature& b) {
  using Halves = std::array<std::uint64_t, 2>;
  const auto of_a = std::bit_cast<Halves>(a.bits), of_b = std::bit_cast<Halves>(b.bits);
  return static_cast<int>(set_bits(of_a[0] ^ of_b[0]) + set_bits(of_a[1] ^ of_b[1]));
}

SignatureBlocks::SignatureBlocks(std::span<const Signature> signatures)
    : size_(signatures.size()), blocks_((signatures.size() + kLanes - 1) / kLanes) {
  for (std::size_t j = 0; j < signatures.size(); ++j) {
    const Nibbles nibbles = nibbles_of(signatures[j]);
    for (std::size_t n = 0; n < kNibbles; ++n) blocks_[j / kLanes].nibbles[n][j % kLanes] = nibbles[n];
  }
}

NearestSignatures nearest_signatures(std::span<const Signature> a, const SignatureBlocks& b,
                                     std::span<const Compared> compared, std::uint8_t within, PopcountSimd limit) {
  Pass pass(b, within, limit);
  NearestSignatures nearest;
  nearest.of_a.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    nearest.of_a.push_back(pass.nearest_of(a[i], static_cast<std::uint32_t>(i), compared[i]));
  }
  nearest.of_b = pass.nearest_of_b();
  return nearest;
}

}  // namespace mapweld
