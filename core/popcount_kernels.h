// Kernels that compare signatures: one is chosen of those that a file has, by what the processor can.
#pragma once

#include <algorithm>

#include "core/processor.h"

#if defined(__x86_64__)
#include <immintrin.h>
// On other architectures there is nothing but the absence of this.
#define MAPWELD_X86_KERNELS 1
#define MAPWELD_AVX2 __attribute__((target("avx2")))
#define MAPWELD_AVX512 __attribute__((target("avx2,avx512f,avx512vpopcntdq")))
#endif

namespace mapweld {

// All find the same. Where MAPWELD_X86_KERNELS is not defined there is but the first.
template <typename Kernel>
struct PopcountKernels {
  Kernel scalar;
  Kernel avx2 = nullptr;
  Kernel avx512 = nullptr;

  // The widest that the processor has, and no wider than `limit`.
  Kernel widest([[maybe_unused]] PopcountSimd limit) const {
#ifdef MAPWELD_X86_KERNELS
    static const PopcountSimd of_processor = widest_popcount();
    const PopcountSimd simd = std::min(limit, of_processor);
    if (simd == PopcountSimd::kAvx512) return avx512;
    if (simd == PopcountSimd::kAvx2) return avx2;
#endif
    return scalar;
  }
};

#ifdef MAPWELD_X86_KERNELS
// Set bits of each byte, by halves of it (Mula, Kurz & Lemire 2018).
MAPWELD_AVX2 inline __m256i bits_of_bytes_avx2(__m256i bytes) {
  const __m256i table =
      _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low = _mm256_set1_epi8(0x0F);
  return _mm256_add_epi8(_mm256_shuffle_epi8(table, _mm256_and_si256(bytes, low)),
                         _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi16(bytes, 4), low)));
}
#endif

}  // namespace mapweld
