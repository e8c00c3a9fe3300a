// Loops compiled twice: for every processor of the architecture, and for AVX2, where they take twice as many numbers at
// a time.
#pragma once

#include "core/processor.h"

// Of a lambda that is given to `wide_loops`, and of what it calls: without it nothing is compiled twice.
#define MAPWELD_INLINE __attribute__((always_inline))

namespace mapweld {

#if defined(__x86_64__)
template <typename Loops>
__attribute__((target("avx2"))) auto loops_with_avx2(const Loops& loops) {
  return loops();
}
#endif

// What `loops` returns: [&]() MAPWELD_INLINE { ... }. The same numbers everywhere: no operation is fused or reordered.
template <typename Loops>
auto wide_loops(const Loops& loops) {
#if defined(__x86_64__)
  static const bool avx2 = has_avx2();
  if (avx2) return loops_with_avx2(loops);
#endif
  return loops();
}

}  // namespace mapweld
