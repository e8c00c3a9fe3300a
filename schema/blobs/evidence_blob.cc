#include "schema/blobs/evidence_blob.h"

#include <algorithm>

#include "core/errors.h"

namespace mapweld::blobs {
namespace {
constexpr char kFormat = 'E';
constexpr std::uint8_t kVersion = 1;
}  // namespace

Bytes encode_evidence(const Verification& verification) {
  if (!std::ranges::is_sorted(verification.inlier_matches)) throw FormatError("inlier matches do not ascend");
  ByteWriter writer(kFormat, kVersion);
  writer.reserve(80 + verification.inlier_matches.size() * 4);
  writer.u8(static_cast<std::uint8_t>(verification.kind));
  for (const double value : verification.geometry) writer.f64(value);
  writer.varint(verification.inlier_matches.size());
  std::int64_t first = 0;
  std::int64_t second = 0;
  for (const auto& [a, b] : verification.inlier_matches) {
    writer.varint(static_cast<std::uint64_t>(a - first));
    writer.zigzag(b - second);
    first = a;
    second = b;
  }
  return std::move(writer).finish();
}

void decode_evidence(std::span<const std::uint8_t> blob, Verification& verification) {
  ByteReader reader(blob, kFormat, kVersion);
  const std::uint8_t kind = reader.u8();
  if (kind > static_cast<std::uint8_t>(GeometryKind::kHomography)) reader.corrupt("its geometry is of no known kind");
  verification.kind = static_cast<GeometryKind>(kind);
  for (double& value : verification.geometry) value = reader.f64();
  verification.inlier_matches.resize(reader.varint32(reader.left()));
  std::int64_t first = 0;
  std::int64_t second = 0;
  for (auto& [a, b] : verification.inlier_matches) {
    first += reader.varint32(UINT16_MAX);
    const std::int64_t step = reader.zigzag();
    if (step < -std::int64_t{UINT16_MAX} || step > UINT16_MAX) reader.corrupt("a match lies outside");
    second += step;
    if (first > UINT16_MAX || second < 0 || second > UINT16_MAX) reader.corrupt("a match lies outside");
    a = static_cast<std::uint16_t>(first);
    b = static_cast<std::uint16_t>(second);
  }
  reader.finish();
}

}  // namespace mapweld::blobs
