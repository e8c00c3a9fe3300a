// What the server and the processes that decode for it say to each other.
//
// Both map one piece of shared memory: the file's bytes at its beginning, the pixels, or a smaller file, behind them. A
// job and its result go over a pair of sockets, a message each. The server believes nothing of a result that it has not
// checked: the other side may have been taken over by the file that it decodes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "core/feature/decode.h"

namespace mapweld::server::decoding {

// Descriptors of a decoding process, as it is started with.
inline constexpr int kSocket = 3;
inline constexpr int kMemory = 4;

inline constexpr std::int64_t kMaxPixels = DecodeOptions{}.max_pixels;

// Behind the file's bytes: grey, then which pixels are used; or a file.
inline constexpr std::size_t kMaxResultBytes = 2 * static_cast<std::size_t>(kMaxPixels);

constexpr std::size_t memory_bytes(std::size_t max_file_bytes) { return max_file_bytes + kMaxResultBytes; }

struct Job {
  std::uint64_t file_bytes = 0;
  std::uint64_t max_file_bytes = 0;  // where the pixels begin
  std::int32_t shrink_to_px = 0;     // wide; 0: decode
  std::uint8_t stretch = 1;          // when decoding
};

enum class Outcome : std::uint8_t {
  kDecoded,
  kRefused,      // the ImageError in `code` and `detail`
  kOutOfMemory,  // more than a decoding process may have
};

struct Result {
  Outcome outcome = Outcome::kDecoded;
  std::uint8_t png = 0;  // else JPEG
  std::uint8_t has_used = 0;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::uint64_t shrunk_bytes = 0;  // of the smaller file
  char code[32] = "";
  char detail[256] = "";
};
static_assert(std::is_trivially_copyable_v<Job> && std::is_trivially_copyable_v<Result>);

// At most what fits, always with its final zero.
template <std::size_t N>
void put(char (&field)[N], const std::string& text) {
  const std::size_t size = std::min(text.size(), N - 1);
  std::memcpy(field, text.data(), size);
  field[size] = '\0';
}

template <std::size_t N>
std::string get(const char (&field)[N]) {
  return {field, strnlen(field, N)};
}

}  // namespace mapweld::server::decoding
