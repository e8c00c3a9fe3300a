// A random order of 0 .. n-1 of which any place can be told alone: nothing is shuffled and nothing remembered.
#pragma once

#include <cstdint>

namespace mapweld {

// A Feistel network of six rounds over an even number of bits that holds n, eight at least, walked in cycles until a
// value below n comes (Black & Rogaway 2002, "Ciphers with arbitrary finite domains"): a permutation, chosen by `key`.
class RandomOrder {
 public:
  // n up to 2^62.
  RandomOrder(std::uint64_t n, std::uint64_t key);

  std::uint64_t size() const { return n_; }
  // What stands at place i < size(). Constant time in the mean.
  std::uint64_t at(std::uint64_t i) const;

 private:
  static constexpr int kRounds = 6;
  std::uint64_t n_;
  int half_bits_ = 1;
  std::uint64_t round_keys_[kRounds] = {};
};

}  // namespace mapweld
