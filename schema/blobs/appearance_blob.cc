#include "schema/blobs/appearance_blob.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/vocabulary/appearance_vector.h"

namespace mapweld::blobs {
namespace {

constexpr char kFormat = 'A';
constexpr std::uint8_t kWithoutSignatures = 1;
constexpr std::uint8_t kWithSignatures = 2;
constexpr std::size_t kGridBytes = 8;  // of an appearance: the four columns

float from_grid(std::uint16_t value, float steps_per_unit) { return static_cast<float>(value) / steps_per_unit; }

std::uint16_t to_grid(float value, float steps_per_unit) {
  const float steps = std::round(value * steps_per_unit);
  if (!(steps >= 0.0f && steps <= 65535.0f) || from_grid(static_cast<std::uint16_t>(steps), steps_per_unit) != value) {
    throw FormatError("an appearance does not lie on the grid");
  }
  return static_cast<std::uint16_t>(steps);
}

struct Head {
  int width_px;
  int height_px;
  std::uint32_t appearances;
};

Head read_head(ByteReader& reader) {
  Head head{};
  head.width_px = static_cast<int>(reader.varint32(INT32_MAX));
  head.height_px = static_cast<int>(reader.varint32(INT32_MAX));
  head.appearances = reader.varint32(reader.left());
  return head;
}

}  // namespace

Bytes encode_appearances(const AppearanceVector& image) {
  if (image.width_px < 0 || image.height_px < 0) throw FormatError("an image has a negative size");
  const bool with_signatures =
      std::ranges::any_of(image.appearances, [](const Appearance& a) { return a.signature != Signature{}; });
  ByteWriter writer(kFormat, with_signatures ? kWithSignatures : kWithoutSignatures);
  writer.reserve(16 + image.appearances.size() * (with_signatures ? 26 : 10));
  writer.varint(static_cast<std::uint64_t>(image.width_px));
  writer.varint(static_cast<std::uint64_t>(image.height_px));
  writer.varint(image.appearances.size());
  std::uint32_t previous = 0;
  for (const Appearance& a : image.appearances) {
    const std::uint32_t word = to_index(a.word);
    if (word < previous) throw FormatError("appearances are not sorted by word");
    writer.varint(word - previous);
    previous = word;
  }
  for (const Appearance& a : image.appearances) writer.u16(to_grid(a.x_px, kPositionsPerPixel));
  for (const Appearance& a : image.appearances) writer.u16(to_grid(a.y_px, kPositionsPerPixel));
  for (const Appearance& a : image.appearances) writer.u16(to_grid(a.scale_px, kScalesPerPixel));
  for (const Appearance& a : image.appearances) writer.u16(to_grid(a.angle_deg, kAnglesPerDegree));
  if (with_signatures) {
    for (const Appearance& a : image.appearances) {
      for (const std::uint32_t word : a.signature.bits) writer.u32(word);
    }
  }
  return std::move(writer).finish();
}

AppearanceVector decode_appearances(std::span<const std::uint8_t> blob) {
  ByteReader reader(blob, kFormat, kWithSignatures);
  const Head head = read_head(reader);
  AppearanceVector image;
  image.width_px = head.width_px;
  image.height_px = head.height_px;
  image.appearances.resize(head.appearances);
  std::uint64_t word = 0;
  for (Appearance& a : image.appearances) {
    word += reader.varint();
    if (word > UINT32_MAX) reader.corrupt("a word is too large");
    a.word = WordId{static_cast<std::uint32_t>(word)};
  }
  for (Appearance& a : image.appearances) a.x_px = from_grid(reader.u16(), kPositionsPerPixel);
  for (Appearance& a : image.appearances) a.y_px = from_grid(reader.u16(), kPositionsPerPixel);
  for (Appearance& a : image.appearances) a.scale_px = from_grid(reader.u16(), kScalesPerPixel);
  for (Appearance& a : image.appearances) a.angle_deg = from_grid(reader.u16(), kAnglesPerDegree);
  if (reader.version() == kWithSignatures) {
    for (Appearance& a : image.appearances) {
      for (std::uint32_t& word : a.signature.bits) word = reader.u32();
    }
  }
  reader.finish();
  return image;
}

void decode_indexed(std::span<const std::uint8_t> blob, IndexedFeatures& features) {
  ByteReader reader(blob, kFormat, kWithSignatures);
  const Head head = read_head(reader);
  features.words.resize(head.appearances);
  features.signatures.assign(head.appearances, 0);
  std::uint64_t word = 0;
  for (WordId& id : features.words) {
    word += reader.varint();
    if (word > UINT32_MAX) reader.corrupt("a word is too large");
    id = WordId{static_cast<std::uint32_t>(word)};
  }
  if (reader.version() != kWithSignatures) return;
  reader.raw(std::size_t{head.appearances} * kGridBytes);
  for (VoteSignature& signature : features.signatures) {
    Signature whole;
    for (std::uint32_t& bits : whole.bits) bits = reader.u32();
    signature = vote_signature(whole);
  }
}

}  // namespace mapweld::blobs
