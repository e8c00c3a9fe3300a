#include "core/retrieval/vote_signature.h"

#include <cstddef>

namespace mapweld {
namespace {

constexpr std::array<std::uint8_t, 64> kBits{
    0,  1,   2,   3,   4,   6,   7,   9,   11,  13,  15,  17,  19,  21,  23,  24,  25,  26,  28,  29, 30, 31,
    33, 37,  39,  42,  43,  54,  57,  59,  63,  65,  67,  71,  74,  77,  78,  89,  90,  93,  94,  95, 96, 97,
    98, 100, 101, 102, 103, 105, 107, 109, 111, 113, 114, 115, 117, 118, 119, 120, 121, 123, 124, 127};

constexpr std::size_t kBytes = 16;  // of a signature

// What each byte of a signature contributes, moved to its place by a shift.
struct Tables {
  std::array<std::array<std::uint8_t, 256>, kBytes> chosen{};
  std::array<std::uint8_t, kBytes> shift{};
};

constexpr Tables make_tables() {
  Tables tables;
  std::size_t next = 0;  // in kBits
  for (std::size_t byte = 0; byte < kBytes; ++byte) {
    const std::size_t first = next;
    while (next < kBits.size() && kBits[next] / 8 == byte) ++next;
    tables.shift[byte] = static_cast<std::uint8_t>(first % 64);
    for (unsigned value = 0; value < 256; ++value) {
      for (std::size_t k = first; k < next; ++k) {
        tables.chosen[byte][value] |= static_cast<std::uint8_t>((value >> kBits[k] % 8 & 1) << (k - first));
      }
    }
  }
  return tables;
}

constexpr Tables kTables = make_tables();

}  // namespace

const std::array<std::uint8_t, 64> kVoteBits = kBits;

VoteSignature vote_signature(const Signature& signature) {
  if (signature == Signature{}) return 0;
  VoteSignature result = 0;
  for (std::size_t byte = 0; byte < kBytes; ++byte) {
    const std::uint32_t value = signature.bits[byte / 4] >> byte % 4 * 8 & 0xFF;
    result |= VoteSignature{kTables.chosen[byte][value]} << kTables.shift[byte];
  }
  return result == 0 ? 1 : result;
}

}  // namespace mapweld
