// What a part of a merge's checkpoint holds, before it is packed and after: numbers, texts, flags and planes of a
// matrix.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/blobs/varint.h"

namespace mapweld::blobs {

// Throws StoreError, kCorrupt.
[[noreturn]] void corrupt_merge_state(const std::string& what);

// The content of a part, to be packed. Unlike ByteWriter it has no frame of its own.
class MergeStateContent {
 public:
  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u64(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
  }
  void varint(std::uint64_t value) { append_varint(bytes_, value); }
  void text(std::string_view value) {
    varint(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }
  void candidate(const Candidate& c) {
    varint(to_index(c.source));
    varint(to_index(c.target));
    varint(c.votes);
  }
  void flags(const std::vector<std::uint8_t>& values) {
    for (std::size_t i = 0; i < values.size(); i += 8) {
      std::uint8_t byte = 0;
      for (std::size_t k = i; k < std::min(i + 8, values.size()); ++k) byte |= (values[k] != 0 ? 1 : 0) << (k - i);
      bytes_.push_back(byte);
    }
  }
  void planes(std::span<const std::uint16_t> values) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + 2 * values.size());
    std::uint8_t* low = bytes_.data() + at;
    std::uint8_t* high = low + values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
      low[i] = static_cast<std::uint8_t>(values[i]);
      high[i] = static_cast<std::uint8_t>(values[i] >> 8);
    }
  }
  // Compressed and framed. Throws FormatError when that fails.
  MergeStatePart pack(std::string name) &&;

 private:
  Bytes bytes_;
};

// Reads what MergeStateContent wrote.
class MergeStateContentReader {
 public:
  // Throws StoreError for a part that is foreign or torn, as every reading function does for content that makes no
  // sense.
  explicit MergeStateContentReader(const MergeStatePart& part);
  std::uint8_t u8() {
    need(1);
    return bytes_[at_++];
  }
  std::uint64_t u64() {
    need(8);
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 8) value |= std::uint64_t{bytes_[at_++]} << shift;
    return value;
  }
  std::uint64_t varint() {
    const std::uint8_t* at = bytes_.data() + at_;
    const auto value = read_varint(at, bytes_.data() + bytes_.size());
    if (!value) fail();
    at_ = static_cast<std::size_t>(at - bytes_.data());
    return *value;
  }
  std::uint32_t varint32() {
    const std::uint64_t value = varint();
    if (value > UINT32_MAX) fail();
    return static_cast<std::uint32_t>(value);
  }
  // A number of things that take at least a byte each.
  std::size_t count() {
    const std::uint64_t value = varint();
    if (value > bytes_.size() - at_) fail();
    return value;
  }
  std::string text() {
    const std::size_t size = count();
    const std::string value(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                            bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
    at_ += size;
    return value;
  }
  Candidate candidate() {
    const VertexId source{varint32()}, target{varint32()};
    return {source, target, varint32()};
  }
  std::vector<std::uint8_t> flags(std::uint64_t size) {
    if (size / 8 > bytes_.size() - at_) fail();
    std::vector<std::uint8_t> values(size);
    std::uint8_t byte = 0;
    for (std::size_t i = 0; i < size; ++i) {
      if (i % 8 == 0) byte = u8();
      values[i] = (byte >> (i % 8)) & 1;
    }
    return values;
  }
  std::vector<std::uint16_t> planes(std::size_t size) {
    if ((bytes_.size() - at_) / 2 < size) fail();
    std::vector<std::uint16_t> values(size);
    const std::uint8_t* low = bytes_.data() + at_;
    const std::uint8_t* high = low + size;
    for (std::size_t i = 0; i < size; ++i) values[i] = static_cast<std::uint16_t>(low[i] | high[i] << 8);
    at_ += 2 * size;
    return values;
  }
  bool at_end() const { return at_ == bytes_.size(); }
  void finish() const {
    if (!at_end()) fail();
  }
  [[noreturn]] void fail() const { corrupt_merge_state("part '" + name_ + "' does not make sense"); }

 private:
  void need(std::size_t bytes) const {
    if (bytes_.size() - at_ < bytes) fail();
  }
  std::string name_;
  Bytes bytes_;
  std::size_t at_ = 0;
};

}  // namespace mapweld::blobs
