#include "schema/blobs/byte_stream.h"

#include <string>
#include <utility>

#include <zlib.h>

namespace mapweld::blobs {
namespace {

std::uint32_t frame_crc(std::span<const std::uint8_t> blob) {
  return crc32(blob.subspan(kFrameBytes), crc32(blob.first(2)));
}

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t so_far) {
  return static_cast<std::uint32_t>(::crc32_z(so_far, bytes.data(), bytes.size()));
}

ByteWriter::ByteWriter(char format, std::uint8_t version) {
  bytes_ = {static_cast<std::uint8_t>(format), version, 0, 0, 0, 0};
}

void ByteWriter::f64(double value) {
  auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 0; i < 8; ++i, bits >>= 8) bytes_.push_back(static_cast<std::uint8_t>(bits));
}

Bytes ByteWriter::finish() && {
  std::uint32_t crc = frame_crc(bytes_);
  for (std::size_t i = 2; i < kFrameBytes; ++i, crc >>= 8) bytes_[i] = static_cast<std::uint8_t>(crc);
  return std::move(bytes_);
}

ByteReader::ByteReader(std::span<const std::uint8_t> blob, char format, std::uint8_t newest)
    : at_(blob.data()), end_(blob.data() + blob.size()), format_(format), version_(0) {
  if (blob.size() < kFrameBytes) corrupt("it is too short");
  if (blob[0] != static_cast<std::uint8_t>(format)) corrupt("it is another format");
  std::uint32_t crc = 0;
  for (std::size_t i = kFrameBytes; i-- > 2;) crc = crc << 8 | blob[i];
  if (crc != frame_crc(blob)) corrupt("its checksum is wrong");
  version_ = blob[1];
  if (version_ == 0 || version_ > newest) {
    throw StoreError(StoreErrorKind::kNewerVersion, std::string("blob '") + format + "' has version " +
                                                        std::to_string(version_) + "; known are versions up to " +
                                                        std::to_string(newest));
  }
  at_ += kFrameBytes;
}

double ByteReader::f64() {
  need(8);
  std::uint64_t bits = 0;
  for (int i = 8; i-- > 0;) bits = bits << 8 | at_[i];
  at_ += 8;
  return std::bit_cast<double>(bits);
}

void ByteReader::corrupt(std::string_view what) const {
  throw StoreError(StoreErrorKind::kCorrupt, std::string("blob '") + format_ + "' is damaged: " + std::string(what));
}

}  // namespace mapweld::blobs
