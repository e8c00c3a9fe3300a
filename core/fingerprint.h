// A 64-bit hash by which a checkpoint knows its input again. Not cryptographic.
#pragma once

#include <cstdint>
#include <string_view>

namespace mapweld {

// Order matters; the same sequence gives the same value on every machine.
class Fingerprint {
 public:
  void add(std::uint64_t number) {
    value_ = (value_ ^ number) * 0x9E3779B97F4A7C15ull;
    value_ ^= value_ >> 29;
  }
  void add(std::string_view text) {
    add(text.size());
    for (const char c : text) add(static_cast<unsigned char>(c));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0x243F6A8885A308D3ull;
};

}  // namespace mapweld
