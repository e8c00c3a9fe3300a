#include "core/retrieval/agreement.h"

#include <algorithm>

#include "core/popcount_kernels.h"

namespace mapweld {
namespace {

using Kernel = void (*)(VoteSignature query, const VoteSignature* list, std::size_t size, std::uint64_t* agreeing);

void find_scalar(VoteSignature query, const VoteSignature* list, std::size_t size, std::uint64_t* agreeing) {
  for (std::size_t from = 0; from < size; from += 64) {
    std::uint64_t word = 0;
    const std::size_t count = std::min<std::size_t>(64, size - from);
    for (std::size_t k = 0; k < count; ++k) word |= std::uint64_t{agree(query, list[from + k])} << k;
    agreeing[from / 64] = word;
  }
}

#ifdef MAPWELD_X86_KERNELS

// Bit k: lane k agrees.
MAPWELD_AVX2 inline std::uint64_t agreeing_avx2(__m256i four, __m256i query) {
  const __m256i zero = _mm256_setzero_si256();
  const __m256i distance = _mm256_sad_epu8(bits_of_bytes_avx2(_mm256_xor_si256(four, query)), zero);
  const __m256i agrees = _mm256_or_si256(_mm256_cmpgt_epi64(_mm256_set1_epi64x(kVoteDistance + 1), distance),
                                         _mm256_cmpeq_epi64(four, zero));
  return static_cast<std::uint64_t>(_mm256_movemask_pd(_mm256_castsi256_pd(agrees)));
}

MAPWELD_AVX2 void find_avx2(VoteSignature query, const VoteSignature* list, std::size_t size, std::uint64_t* agreeing) {
  const __m256i all_query = _mm256_set1_epi64x(static_cast<long long>(query));
  for (std::size_t from = 0; from < size; from += 64) {
    std::uint64_t word = 0;
    const std::size_t count = std::min<std::size_t>(64, size - from);
    std::size_t k = 0;
    for (; k + 4 <= count; k += 4) {
      const __m256i four = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(list + from + k));
      word |= agreeing_avx2(four, all_query) << k;
    }
    if (k < count) {
      const auto left = static_cast<long long>(count - k);
      const __m256i inside = _mm256_cmpgt_epi64(_mm256_set1_epi64x(left), _mm256_setr_epi64x(0, 1, 2, 3));
      const __m256i rest = _mm256_maskload_epi64(reinterpret_cast<const long long*>(list + from + k), inside);
      word |= (agreeing_avx2(rest, all_query) & ((1u << left) - 1)) << k;
    }
    agreeing[from / 64] = word;
  }
}

MAPWELD_AVX512 void find_avx512(VoteSignature query, const VoteSignature* list, std::size_t size,
                                std::uint64_t* agreeing) {
  const __m512i all_query = _mm512_set1_epi64(static_cast<long long>(query));
  const __m512i most = _mm512_set1_epi64(kVoteDistance);
  for (std::size_t from = 0; from < size; from += 64) {
    std::uint64_t word = 0;
    const std::size_t count = std::min<std::size_t>(64, size - from);
    for (std::size_t k = 0; k < count; k += 8) {
      const auto inside = static_cast<__mmask8>(0xFFu >> (8 - std::min<std::size_t>(8, count - k)));
      const __m512i eight = _mm512_maskz_loadu_epi64(inside, list + from + k);
      const __m512i distance = _mm512_popcnt_epi64(_mm512_xor_si512(eight, all_query));
      const unsigned agrees = _mm512_cmple_epu64_mask(distance, most) | _mm512_testn_epi64_mask(eight, eight);
      word |= static_cast<std::uint64_t>(agrees & inside) << k;
    }
    agreeing[from / 64] = word;
  }
}

constexpr PopcountKernels<Kernel> kKernels{find_scalar, find_avx2, find_avx512};
#else
constexpr PopcountKernels<Kernel> kKernels{find_scalar};
#endif

}  // namespace

void find_agreeing(VoteSignature query, std::span<const VoteSignature> list, std::uint64_t* agreeing,
                   PopcountSimd limit) {
  if (query == 0) {
    std::fill_n(agreeing, agreement_words(list.size()), ~std::uint64_t{0});
    if (list.size() % 64 != 0) agreeing[list.size() / 64] = (std::uint64_t{1} << list.size() % 64) - 1;
    return;
  }
  kKernels.widest(limit)(query, list.data(), list.size(), agreeing);
}

}  // namespace mapweld
