// Writing and reading the bytes of blobs: little-endian numbers, varints, and the frame around every blob.
//
// The frame: byte 0 names the format (an ASCII letter), byte 1 its version, bytes 2 .. 5 are the CRC-32 (zlib's, that
// is IEEE 802.3; little-endian) of byte 0, byte 1 and the payload, which follows from byte 6 to the end.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "schema/blobs/varint.h"
#include "schema/engine/store_error.h"

namespace mapweld::blobs {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::size_t kFrameBytes = 6;

// Builds a framed blob.
class ByteWriter {
 public:
  // Begins a frame.
  ByteWriter(char format, std::uint8_t version);

  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value) {
    bytes_.push_back(static_cast<std::uint8_t>(value));
    bytes_.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  void u32(std::uint32_t value) {
    u16(static_cast<std::uint16_t>(value));
    u16(static_cast<std::uint16_t>(value >> 16));
  }
  void f64(double value);
  void varint(std::uint64_t value) { append_varint(bytes_, value); }
  // Small numbers of either sign: 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
  void zigzag(std::int64_t value) {
    varint((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
  }
  void raw(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void reserve(std::size_t payload_bytes) { bytes_.reserve(kFrameBytes + payload_bytes); }

  // Completes the frame and hands it out.
  Bytes finish() &&;

 private:
  Bytes bytes_;
};

// Reads a framed blob. Throws StoreError: kCorrupt when the frame is foreign, torn or its checksum wrong, or when a
// read goes past the end; kNewerVersion when the version is beyond `newest`.
class ByteReader {
 public:
  ByteReader(std::span<const std::uint8_t> blob, char format, std::uint8_t newest);

  std::uint8_t version() const { return version_; }
  std::uint8_t u8() {
    need(1);
    return *at_++;
  }
  std::uint16_t u16() {
    need(2);
    const auto value = static_cast<std::uint16_t>(at_[0] | at_[1] << 8);
    at_ += 2;
    return value;
  }
  std::uint32_t u32() {
    const std::uint32_t low = u16();
    return low | std::uint32_t{u16()} << 16;
  }
  double f64();
  std::uint64_t varint() {
    if (const auto value = read_varint(at_, end_)) return *value;
    corrupt("a varint does not end");
  }
  // A varint of at most `most`.
  std::uint32_t varint32(std::uint64_t most = UINT32_MAX) {
    const std::uint64_t value = varint();
    if (value > most) corrupt("a number is too large");
    return static_cast<std::uint32_t>(value);
  }
  std::int64_t zigzag() {
    const std::uint64_t value = varint();
    return static_cast<std::int64_t>((value >> 1) ^ (~(value & 1) + 1));
  }
  std::span<const std::uint8_t> raw(std::size_t bytes) {
    need(bytes);
    const std::span<const std::uint8_t> piece(at_, bytes);
    at_ += bytes;
    return piece;
  }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  // Every byte must have been read.
  void finish() const {
    if (at_ != end_) corrupt("bytes are left over");
  }
  [[noreturn]] void corrupt(std::string_view what) const;

 private:
  void need(std::size_t bytes) const {
    if (left() < bytes) corrupt("it ends too early");
  }
  const std::uint8_t* at_;
  const std::uint8_t* end_;
  char format_;
  std::uint8_t version_;
};

// zlib's CRC-32.
std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t so_far = 0);

}  // namespace mapweld::blobs
