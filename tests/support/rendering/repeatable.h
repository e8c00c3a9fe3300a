// Numbers that are the same on every machine: a small generator, hashes and trigonometry.
//
// The standard library's distributions and libm's sin may differ between libraries and processors, and a rendered
// world must not. Everything here is integer arithmetic or plain IEEE additions and multiplications.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.h"

namespace mapweld::rendered {

// SplitMix64's first number from the seed `x`.
constexpr std::uint64_t mix(std::uint64_t x) { return next_random(x); }

// A hash of whole numbers, in order.
template <typename... Parts>
constexpr std::uint64_t hash_of(Parts... parts) {
  std::uint64_t h = 0x51ed270b0a1f39c1ULL;
  ((h = mix(h ^ static_cast<std::uint64_t>(parts))), ...);
  return h;
}

// SplitMix64. Callers draw in separate statements or braced lists: the order of function arguments is not fixed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix(seed)) {}

  std::uint64_t next() { return next_random(state_); }
  // In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // In [0, n), n > 0.
  int below(int n) { return static_cast<int>(((next() >> 32) * static_cast<std::uint64_t>(n)) >> 32); }
  // In [low, high].
  int between(int low, int high) { return low + below(high - low + 1); }
  bool chance(double probability) { return uniform() < probability; }
  // Mean 0, deviation 1, within +-3.5: the sum of twelve uniform numbers, less six (Irwin-Hall), cut.
  double gaussian() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum < -3.5 ? -3.5 : (sum > 3.5 ? 3.5 : sum);
  }
  template <typename T>
  const T& pick(const std::vector<T>& values) {
    return values[static_cast<std::size_t>(below(static_cast<int>(values.size())))];
  }
  template <typename T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) {
      std::swap(values[i - 1], values[static_cast<std::size_t>(below(static_cast<int>(i)))]);
    }
  }

 private:
  std::uint64_t state_;
};

// Changes slowly with t, within +-1; whole numbers of t are a turn apart.
inline double slow_noise(std::uint64_t seed, double t) {
  const double whole = std::floor(t);
  const auto lattice = [seed](double i) { return Random(hash_of(seed, static_cast<std::int64_t>(i))).uniform(-1, 1); };
  const double f = t - whole;
  const double s = f * f * (3 - 2 * f);
  return lattice(whole) * (1 - s) + lattice(whole + 1) * s;
}

// In [0, 360).
inline double wrap_deg(double angle_deg) {
  const double wrapped = angle_deg - 360.0 * std::floor(angle_deg / 360.0);
  return wrapped >= 360.0 ? 0.0 : wrapped;
}

// In [-180, 180).
inline double signed_deg(double angle_deg) { return wrap_deg(angle_deg + 180.0) - 180.0; }

// Taylor's series to x^15 on [-90, 90] degrees: error below 1e-11.
inline double sin_deg(double angle_deg) {
  double a = signed_deg(angle_deg);
  if (a > 90) a = 180 - a;
  if (a < -90) a = -180 - a;
  const double x = a * 0.017453292519943295;
  const double q = x * x;
  double sum = 1;
  for (int n = 15; n >= 3; n -= 2) sum = 1 - q / static_cast<double>(n * (n - 1)) * sum;
  return x * sum;
}
inline double cos_deg(double angle_deg) { return sin_deg(angle_deg + 90.0); }

}  // namespace mapweld::rendered
