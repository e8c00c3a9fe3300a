// Whole numbers in as many bytes as they need (LEB128): 7 bits a byte, the lowest first; the high bit says that more
// follow.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace mapweld::blobs {

inline void append_varint(std::vector<std::uint8_t>& bytes, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 0x80));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

// Moves `at` behind the number. Nothing when it does not end before `end`, or goes on beyond 64 bits.
inline std::optional<std::uint64_t> read_varint(const std::uint8_t*& at, const std::uint8_t* end) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && at != end; shift += 7) {
    const std::uint8_t byte = *at++;
    if (shift == 63 && byte > 1) return std::nullopt;
    value |= std::uint64_t{byte & 0x7fU} << shift;
    if (byte < 0x80) return value;
  }
  return std::nullopt;
}

}  // namespace mapweld::blobs
