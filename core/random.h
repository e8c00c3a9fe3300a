// Random numbers that are the same with every standard library: SplitMix64 (Steele, Lea & Flood 2014).
#pragma once

#include <cstdint>

namespace mapweld {

// Every bit of the result depends on every bit of `z`; one to one.
constexpr std::uint64_t mix_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

// By so much the state goes on from draw to draw: 2^64 over the golden ratio.
inline constexpr std::uint64_t kGoldenGamma = 0x9E3779B97F4A7C15ull;

// The next 64 bits; `state` is all that is remembered.
constexpr std::uint64_t next_random(std::uint64_t& state) { return mix_bits(state += kGoldenGamma); }

// A sequence of draws from one seed.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() { return next_random(state_); }

  // Uniform in [0, bound), bound > 0, by multiplication: off by less than bound / 2^64.
  std::uint64_t below(std::uint64_t bound) {
    __extension__ using Wide = unsigned __int128;
    return static_cast<std::uint64_t>((Wide{next()} * bound) >> 64);
  }
  // The same by the upper half of the bits: off by less than bound / 2^32.
  std::uint32_t below32(std::uint32_t bound) { return static_cast<std::uint32_t>(((next() >> 32) * bound) >> 32); }

 private:
  std::uint64_t state_;
};

}  // namespace mapweld
