// Random numbers that are the same with every standard library: SplitMix64 (Steele, Lea & Flood 2014).
#pragma once

#include <cstdint>

namespace mapweld {

// The next 64 bits; `state` is all that is remembered.
constexpr std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15ull;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

}  // namespace mapweld
