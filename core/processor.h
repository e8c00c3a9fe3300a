// What this processor can do beyond the baseline that the build assumes.
#pragma once

#include <cstdint>

namespace mapweld {

// Where it cannot, and on other architectures: false.
inline bool has_avx2() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

// Instruction sets by which signatures are compared, ascending; all find the same.
enum class PopcountSimd : std::uint8_t { kScalar, kAvx2, kAvx512 };

// The widest that this processor has.
inline PopcountSimd widest_popcount() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vpopcntdq")) return PopcountSimd::kAvx512;
#endif
  return has_avx2() ? PopcountSimd::kAvx2 : PopcountSimd::kScalar;
}

}  // namespace mapweld
