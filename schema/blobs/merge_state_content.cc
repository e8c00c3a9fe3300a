#include "schema/blobs/merge_state_content.h"

#include <utility>

#include <zstd.h>

#include "core/errors.h"

namespace mapweld::blobs {
namespace {

constexpr char kFormat = 'M';
constexpr std::uint8_t kVersion = 1;
constexpr int kLevel = 1;  // S is written while the merge waits: speed counts
constexpr std::uint64_t kMostContent = std::uint64_t{1} << 34;

}  // namespace

void corrupt_merge_state(const std::string& what) {
  throw StoreError(StoreErrorKind::kCorrupt, "a merge's checkpoint is damaged: " + what);
}

MergeStatePart MergeStateContent::pack(std::string name) && {
  Bytes packed(ZSTD_compressBound(bytes_.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes_.data(), bytes_.size(), kLevel);
  if (ZSTD_isError(size)) throw FormatError("a merge state cannot be packed");
  ByteWriter writer(kFormat, kVersion);
  writer.reserve(size + 10);
  writer.varint(bytes_.size());
  writer.raw(std::span(packed).first(size));
  return {std::move(name), std::move(writer).finish()};
}

MergeStateContentReader::MergeStateContentReader(const MergeStatePart& part) : name_(part.name) {
  ByteReader reader(part.bytes, kFormat, kVersion);
  const std::uint64_t size = reader.varint();
  const std::span<const std::uint8_t> packed = reader.raw(reader.left());
  if (size > kMostContent || ZSTD_getFrameContentSize(packed.data(), packed.size()) != size) fail();
  bytes_.resize(size);
  if (ZSTD_decompress(bytes_.data(), size, packed.data(), packed.size()) != size) fail();
}

}  // namespace mapweld::blobs
