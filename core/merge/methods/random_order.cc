#include "core/merge/methods/random_order.h"

#include <algorithm>
#include <bit>

#include "core/random.h"

namespace mapweld {

RandomOrder::RandomOrder(std::uint64_t n, std::uint64_t key) : n_(n) {
  const int bits = n <= 1 ? 1 : std::bit_width(n - 1);
  half_bits_ = std::max(4, (bits + 1) / 2);
  for (std::uint64_t& round_key : round_keys_) round_key = next_random(key);
}

std::uint64_t RandomOrder::at(std::uint64_t i) const {
  const std::uint64_t mask = (std::uint64_t{1} << half_bits_) - 1;
  do {
    std::uint64_t left = i >> half_bits_, right = i & mask;
    for (const std::uint64_t round_key : round_keys_) {
      std::uint64_t mixed = right ^ round_key;
      const std::uint64_t next = left ^ (next_random(mixed) & mask);
      left = right;
      right = next;
    }
    i = left << half_bits_ | right;
  } while (i >= n_);
  return i;
}

}  // namespace mapweld
