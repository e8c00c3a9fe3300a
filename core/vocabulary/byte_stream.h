// Little-endian numbers in and out of bytes, for the formats of this folder.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/errors.h"

namespace mapweld {

static_assert(std::endian::native == std::endian::little, "the formats are little-endian and so are the machines");

class ByteWriter {
 public:
  template <typename Number>
  void number(Number value) {
    static_assert(std::is_arithmetic_v<Number>);
    append(&value, sizeof value);
  }
  // A length (u64) and the elements.
  template <typename Number>
  void array(std::span<const Number> values) {
    number<std::uint64_t>(values.size());
    append(values.data(), values.size_bytes());
  }
  void text(std::string_view value) { array(std::span(value.data(), value.size())); }

  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  // Out of line: inlined, GCC 12 warns of overflows that cannot be.
  [[gnu::noinline]] void append(const void* data, std::size_t count) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + count);
    if (count > 0) std::memcpy(bytes_.data() + at, data, count);
  }

  std::vector<std::uint8_t> bytes_;
};

// Throws FormatError wherever the bytes end too early.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <typename Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    Number value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  template <typename Number>
  std::vector<Number> array() {
    const auto count = number<std::uint64_t>();
    if (count > rest_.size() / sizeof(Number)) throw FormatError("the data end too early");
    std::vector<Number> values(count);
    const auto bytes = take(count * sizeof(Number));
    if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  std::string text() {
    const auto characters = array<char>();
    return {characters.begin(), characters.end()};
  }
  void expect_end() const {
    if (!rest_.empty()) throw FormatError("the data go on after their end");
  }

 private:
  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > rest_.size()) throw FormatError("the data end too early");
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  std::span<const std::uint8_t> rest_;
};

}  // namespace mapweld
