// What this processor can do beyond the baseline that the build assumes.
#pragma once

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

}  // namespace mapweld
