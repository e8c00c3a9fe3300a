// Set bits of bytes with AVX2, for kernels that compare signatures. Only for code that has asked the processor
// (core/processor.h); on other architectures nothing but the absence of MAPWELD_X86_KERNELS.
#pragma once

#if defined(__x86_64__)
#include <immintrin.h>
#define MAPWELD_X86_KERNELS 1
#define MAPWELD_AVX2 __attribute__((target("avx2")))

namespace mapweld {

// Set bits of each byte, by halves of it (Mula, Kurz & Lemire 2018).
MAPWELD_AVX2 inline __m256i bits_of_bytes_avx2(__m256i bytes) {
  const __m256i table =
      _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low = _mm256_set1_epi8(0x0F);
  return _mm256_add_epi8(_mm256_shuffle_epi8(table, _mm256_and_si256(bytes, low)),
                         _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi16(bytes, 4), low)));
}

}  // namespace mapweld
#endif
