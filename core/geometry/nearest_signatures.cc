#include "core/geometry/nearest_signatures.h"

#include <algorithm>
#include <cstddef>

#include "core/popcount_kernels.h"

namespace mapweld {
namespace {

// A neighbour as one number, distance above, index below: the least is the nearest, and the first of several.
constexpr std::uint32_t kNobody = 0xFFFFFFFF;
constexpr std::uint32_t key(std::uint32_t distance, std::uint32_t index) { return distance << 16 | index; }

void offer(std::uint32_t offered, std::uint32_t& best, std::uint32_t& second) {
  second = std::min(second, std::max(best, offered));
  best = std::min(best, offered);
}

// Sixteen signatures of the second list by columns, and their nearest among the rows so far: six cache lines.
struct alignas(64) Block {
  std::array<std::array<std::uint32_t, 16>, 4> bits{};
  std::array<std::uint32_t, 16> best, second;
};
constexpr std::size_t kBlock = 16;

std::vector<Block> in_blocks(std::span<const Signature> signatures) {
  std::vector<Block> blocks((signatures.size() + kBlock - 1) / kBlock);
  for (Block& block : blocks) {
    block.best.fill(kNobody);
    block.second.fill(kNobody);
  }
  for (std::size_t j = 0; j < signatures.size(); ++j) {
    for (std::size_t k = 0; k < 4; ++k) blocks[j / kBlock].bits[k][j % kBlock] = signatures[j].bits[k];
  }
  return blocks;
}

struct Row {
  std::uint32_t best = kNobody;
  std::uint32_t second = kNobody;
};

// Compares row `i` with the columns from..to-1: keeps theirs, adds to its own.
using Kernel = void (*)(const Signature& row, std::uint32_t i, std::size_t from, std::size_t to, Block* blocks,
                        Row& own);

// Without an instruction for it std::popcount looks tables up; this is a dozen operations for 32 bits.
constexpr std::uint32_t set_bits(std::uint32_t word) {
  word -= word >> 1 & 0x55555555;
  word = (word & 0x33333333) + (word >> 2 & 0x33333333);
  return ((word + (word >> 4)) & 0x0F0F0F0F) * 0x01010101 >> 24;
}

void compare_scalar(const Signature& row, std::uint32_t i, std::size_t from, std::size_t to, Block* blocks, Row& own) {
  for (std::size_t j = from; j < to; ++j) {
    Block& block = blocks[j / kBlock];
    const std::size_t lane = j % kBlock;
    std::uint32_t distance = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      distance += set_bits(row.bits[k] ^ block.bits[k][lane]);
    }
    offer(key(distance, static_cast<std::uint32_t>(j)), own.best, own.second);
    offer(key(distance, i), block.best[lane], block.second[lane]);
  }
}

#ifdef MAPWELD_X86_KERNELS

MAPWELD_AVX2 inline __m256i load_avx2(const std::uint32_t* from) {
  return _mm256_load_si256(reinterpret_cast<const __m256i*>(from));
}
MAPWELD_AVX2 inline void store_avx2(std::uint32_t* to, __m256i value) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(to), value);
}

MAPWELD_AVX2 inline std::uint32_t least_lane(__m256i lanes) {
  __m128i least = _mm_min_epu32(_mm256_castsi256_si128(lanes), _mm256_extracti128_si256(lanes, 1));
  least = _mm_min_epu32(least, _mm_shuffle_epi32(least, _MM_SHUFFLE(1, 0, 3, 2)));
  least = _mm_min_epu32(least, _mm_shuffle_epi32(least, _MM_SHUFFLE(2, 3, 0, 1)));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(least));
}

// The two least of `best` and `second`; that of a lane's two is in `best`. Numbers differ, save for nobody's.
MAPWELD_AVX2 inline void offer_all(__m256i best, __m256i second, Row& own) {
  const std::uint32_t least = least_lane(best);
  const __m256i is_least = _mm256_cmpeq_epi32(best, _mm256_set1_epi32(static_cast<int>(least)));
  offer(least, own.best, own.second);
  offer(least_lane(_mm256_min_epu32(_mm256_or_si256(best, is_least), second)), own.best, own.second);
}

MAPWELD_AVX2 void compare_avx2(const Signature& row, std::uint32_t i, std::size_t from, std::size_t to, Block* blocks,
                               Row& own) {
  __m256i query[4];
  for (std::size_t k = 0; k < 4; ++k) query[k] = _mm256_set1_epi32(static_cast<int>(row.bits[k]));
  const __m256i rows_index = _mm256_set1_epi32(static_cast<int>(i));
  const __m256i before = _mm256_set1_epi32(static_cast<int>(from));
  const __m256i last = _mm256_set1_epi32(static_cast<int>(to) - 1);
  const std::size_t first = from / 8 * 8;
  __m256i index =
      _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  __m256i best = _mm256_set1_epi32(-1);
  __m256i second = best;
  for (std::size_t j = first; j < to; j += 8) {
    Block& block = blocks[j / kBlock];
    const std::size_t lane = j % kBlock;
    __m256i bytes = _mm256_setzero_si256();
    for (std::size_t k = 0; k < 4; ++k) {
      bytes = _mm256_add_epi8(bytes, bits_of_bytes_avx2(_mm256_xor_si256(query[k], load_avx2(&block.bits[k][lane]))));
    }
    const __m256i words = _mm256_maddubs_epi16(bytes, _mm256_set1_epi8(1));
    __m256i distance = _mm256_slli_epi32(_mm256_madd_epi16(words, _mm256_set1_epi16(1)), 16);
    const __m256i outside = _mm256_or_si256(_mm256_cmpgt_epi32(before, index), _mm256_cmpgt_epi32(index, last));
    distance = _mm256_or_si256(distance, outside);  // all ones: nobody
    const __m256i by_row = _mm256_or_si256(distance, index);
    second = _mm256_min_epu32(second, _mm256_max_epu32(best, by_row));
    best = _mm256_min_epu32(best, by_row);
    const __m256i by_column = _mm256_or_si256(distance, rows_index);
    const __m256i column_best = load_avx2(&block.best[lane]);
    store_avx2(&block.second[lane],
               _mm256_min_epu32(load_avx2(&block.second[lane]), _mm256_max_epu32(column_best, by_column)));
    store_avx2(&block.best[lane], _mm256_min_epu32(column_best, by_column));
    index = _mm256_add_epi32(index, _mm256_set1_epi32(8));
  }
  offer_all(best, second, own);
}

// With a mask of all lanes: GCC 12 warns of the plain forms.
MAPWELD_AVX512 inline __m512i least_avx512(__m512i a, __m512i b) { return _mm512_maskz_min_epu32(0xFFFF, a, b); }
MAPWELD_AVX512 inline __m512i greatest_avx512(__m512i a, __m512i b) { return _mm512_maskz_max_epu32(0xFFFF, a, b); }

MAPWELD_AVX512 void compare_avx512(const Signature& row, std::uint32_t i, std::size_t from, std::size_t to,
                                   Block* blocks, Row& own) {
  __m512i query[4];
  for (std::size_t k = 0; k < 4; ++k) query[k] = _mm512_set1_epi32(static_cast<int>(row.bits[k]));
  const __m512i nobody = _mm512_set1_epi32(-1);
  const __m512i rows_index = _mm512_set1_epi32(static_cast<int>(i));
  const std::size_t first = from / 16 * 16;
  __m512i index = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)),
                                   _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
  __m512i best = nobody;
  __m512i second = nobody;
  for (std::size_t j = first; j < to; j += 16) {
    Block& block = blocks[j / 16];
    unsigned inside = 0xFFFF;
    if (j < from) inside &= 0xFFFFu << (from - j);
    if (to - j < 16) inside &= (1u << (to - j)) - 1;
    __m512i distance = _mm512_setzero_si512();
    for (std::size_t k = 0; k < 4; ++k) {
      distance = _mm512_add_epi32(
          distance, _mm512_popcnt_epi32(_mm512_xor_si512(query[k], _mm512_load_si512(block.bits[k].data()))));
    }
    distance = _mm512_mask_slli_epi32(nobody, static_cast<__mmask16>(inside), distance, 16);
    const __m512i by_row = _mm512_or_si512(distance, index);
    second = least_avx512(second, greatest_avx512(best, by_row));
    best = least_avx512(best, by_row);
    const __m512i by_column = _mm512_or_si512(distance, rows_index);
    const __m512i column_best = _mm512_load_si512(block.best.data());
    _mm512_store_si512(block.second.data(),
                       least_avx512(_mm512_load_si512(block.second.data()), greatest_avx512(column_best, by_column)));
    _mm512_store_si512(block.best.data(), least_avx512(column_best, by_column));
    index = _mm512_add_epi32(index, _mm512_set1_epi32(16));
  }
  // Sixteen lanes to eight: the lesser of two bests is one, the greater stands with the seconds.
  const __m256i low = _mm512_maskz_extracti64x4_epi64(0xF, best, 0),
                high = _mm512_maskz_extracti64x4_epi64(0xF, best, 1);
  const __m256i seconds = _mm256_min_epu32(_mm512_maskz_extracti64x4_epi64(0xF, second, 0),
                                           _mm512_maskz_extracti64x4_epi64(0xF, second, 1));
  offer_all(_mm256_min_epu32(low, high), _mm256_min_epu32(_mm256_max_epu32(low, high), seconds), own);
}

constexpr PopcountKernels<Kernel> kKernels{compare_scalar, compare_avx2, compare_avx512};
#else
constexpr PopcountKernels<Kernel> kKernels{compare_scalar};
#endif

NearestSignature told(std::uint32_t best, std::uint32_t second) {
  if (best == kNobody) return {};
  return {best & 0xFFFF, best >> 16, second == kNobody ? kNoDistance : second >> 16};
}

}  // namespace

int hamming_distance(const Signature& a, const Signature& b) {
  std::uint32_t distance = 0;
  for (std::size_t k = 0; k < a.bits.size(); ++k) distance += set_bits(a.bits[k] ^ b.bits[k]);
  return static_cast<int>(distance);
}

NearestSignatures nearest_signatures(std::span<const Signature> a, std::span<const Signature> b,
                                     std::span<const Compared> compared, PopcountSimd limit) {
  const Kernel compare = kKernels.widest(limit);
  std::vector<Block> blocks = in_blocks(b);
  NearestSignatures nearest;
  nearest.of_a.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    Row own;
    const std::size_t first = compared[i].first, end = first + compared[i].count;
    const auto row = static_cast<std::uint32_t>(i);
    compare(a[i], row, first, std::min(end, b.size()), blocks.data(), own);
    if (end > b.size()) compare(a[i], row, 0, end - b.size(), blocks.data(), own);
    nearest.of_a.push_back(told(own.best, own.second));
  }
  nearest.of_b.reserve(b.size());
  for (std::size_t j = 0; j < b.size(); ++j) {
    const Block& block = blocks[j / kBlock];
    nearest.of_b.push_back(told(block.best[j % kBlock], block.second[j % kBlock]));
  }
  return nearest;
}

}  // namespace mapweld
