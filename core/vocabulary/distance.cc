#include "core/vocabulary/distance.h"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#define MAPWELD_X86_KERNELS 1
#endif

#include "core/processor.h"

namespace mapweld {
namespace {

constexpr std::size_t kBytes = kDescriptorDimension;

SquaredDistance pair_scalar(const std::uint8_t* a, const std::uint8_t* b) {
  SquaredDistance sum = 0;
  for (std::size_t i = 0; i < kBytes; ++i) {
    const int difference = int{a[i]} - int{b[i]};
    sum += static_cast<SquaredDistance>(difference * difference);
  }
  return sum;
}

void gather_scalar(const std::uint8_t* query, const std::uint8_t* table, const std::uint32_t* rows, std::size_t count,
                   SquaredDistance* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = pair_scalar(query, table + std::size_t{rows[i]} * kBytes);
}

constexpr DistanceKernel kScalarKernel{gather_scalar, pair_scalar, Simd::kScalar};

#ifdef MAPWELD_X86_KERNELS

// A byte difference needs 9 bits: |a - b| as bytes, widened to 16, squared and summed in pairs to 32.
__attribute__((target("avx2"))) inline __m256i squares_avx2(__m256i a, __m256i b) {
  const __m256i zero = _mm256_setzero_si256();
  const __m256i difference = _mm256_or_si256(_mm256_subs_epu8(a, b), _mm256_subs_epu8(b, a));
  const __m256i low = _mm256_unpacklo_epi8(difference, zero);
  const __m256i high = _mm256_unpackhi_epi8(difference, zero);
  return _mm256_add_epi32(_mm256_madd_epi16(low, low), _mm256_madd_epi16(high, high));
}

__attribute__((target("avx2"))) inline SquaredDistance sum_avx2(__m256i lanes) {
  __m128i sum = _mm_add_epi32(_mm256_castsi256_si128(lanes), _mm256_extracti128_si256(lanes, 1));
  sum = _mm_add_epi32(sum, _mm_shuffle_epi32(sum, _MM_SHUFFLE(1, 0, 3, 2)));
  sum = _mm_add_epi32(sum, _mm_shuffle_epi32(sum, _MM_SHUFFLE(2, 3, 0, 1)));
  return static_cast<SquaredDistance>(_mm_cvtsi128_si32(sum));
}

__attribute__((target("avx2"))) inline __m256i load_avx2(const std::uint8_t* bytes) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes));
}

__attribute__((target("avx2"))) inline SquaredDistance distance_avx2(const __m256i query[4], const std::uint8_t* row) {
  const __m256i first =
      _mm256_add_epi32(squares_avx2(query[0], load_avx2(row)), squares_avx2(query[1], load_avx2(row + 32)));
  const __m256i second =
      _mm256_add_epi32(squares_avx2(query[2], load_avx2(row + 64)), squares_avx2(query[3], load_avx2(row + 96)));
  return sum_avx2(_mm256_add_epi32(first, second));
}

__attribute__((target("avx2"))) void gather_avx2(const std::uint8_t* query, const std::uint8_t* table,
                                                 const std::uint32_t* rows, std::size_t count, SquaredDistance* out) {
  const __m256i parts[4] = {load_avx2(query), load_avx2(query + 32), load_avx2(query + 64), load_avx2(query + 96)};
  for (std::size_t i = 0; i < count; ++i) out[i] = distance_avx2(parts, table + std::size_t{rows[i]} * kBytes);
}

__attribute__((target("avx2"))) SquaredDistance pair_avx2(const std::uint8_t* a, const std::uint8_t* b) {
  const __m256i parts[4] = {load_avx2(a), load_avx2(a + 32), load_avx2(a + 64), load_avx2(a + 96)};
  return distance_avx2(parts, b);
}

constexpr DistanceKernel kAvx2Kernel{gather_avx2, pair_avx2, Simd::kAvx2};

#define MAPWELD_VNNI __attribute__((target("avx2,avx512f,avx512bw,avx512vnni")))

MAPWELD_VNNI inline __m512i load_vnni(const std::uint8_t* bytes) { return _mm512_loadu_si512(bytes); }

// |a - b| squared: dpwssd multiplies signed 16-bit pairs and accumulates, one instruction instead of three.
MAPWELD_VNNI inline __m512i squares_vnni(__m512i sum, __m512i a, __m512i b) {
  const __m512i zero = _mm512_setzero_si512();
  const __m512i difference = _mm512_or_si512(_mm512_subs_epu8(a, b), _mm512_subs_epu8(b, a));
  const __m512i low = _mm512_unpacklo_epi8(difference, zero);
  const __m512i high = _mm512_unpackhi_epi8(difference, zero);
  return _mm512_dpwssd_epi32(_mm512_dpwssd_epi32(sum, low, low), high, high);
}

MAPWELD_VNNI inline SquaredDistance distance_vnni(__m512i query_low, __m512i query_high, const std::uint8_t* row) {
  const __m512i low = squares_vnni(_mm512_setzero_si512(), query_low, load_vnni(row));
  const __m512i sum = squares_vnni(low, query_high, load_vnni(row + 64));
  return sum_avx2(
      _mm256_add_epi32(_mm512_maskz_extracti64x4_epi64(0xF, sum, 0), _mm512_maskz_extracti64x4_epi64(0xF, sum, 1)));
}

MAPWELD_VNNI void gather_vnni(const std::uint8_t* query, const std::uint8_t* table, const std::uint32_t* rows,
                              std::size_t count, SquaredDistance* out) {
  const __m512i low = load_vnni(query);
  const __m512i high = load_vnni(query + 64);
  for (std::size_t i = 0; i < count; ++i) out[i] = distance_vnni(low, high, table + std::size_t{rows[i]} * kBytes);
}

MAPWELD_VNNI SquaredDistance pair_vnni(const std::uint8_t* a, const std::uint8_t* b) {
  return distance_vnni(load_vnni(a), load_vnni(a + 64), b);
}

constexpr DistanceKernel kVnniKernel{gather_vnni, pair_vnni, Simd::kAvx512Vnni};

Simd detect() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vnni")) {
    return Simd::kAvx512Vnni;
  }
  return has_avx2() ? Simd::kAvx2 : Simd::kScalar;
}

#endif

}  // namespace

const DistanceKernel& distance_kernel(Simd limit) {
#ifdef MAPWELD_X86_KERNELS
  static const Simd best = detect();
  switch (std::min(limit, best)) {
    case Simd::kAvx512Vnni:
      return kVnniKernel;
    case Simd::kAvx2:
      return kAvx2Kernel;
    case Simd::kScalar:
      break;
  }
#else
  static_cast<void>(limit);
#endif
  return kScalarKernel;
}

}  // namespace mapweld
