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
constexpr std::uint8_t kWithStatic = 3;
constexpr std::size_t kGridBytes = 8;  // of an appearance: the four columns

float from_grid(std::uint16_t value, float steps_per_unit) { return static_cast<float>(value) / steps_per_unit; }

std::uint16_t to_grid(float value, float steps_per_unit) {
  const float steps = std::round(value * steps_per_unit);
  if (!(steps >= 0.0f && steps <= 65535.0f) || from_grid(static_cast<std::uint16_t>(steps), steps_per_unit) != value) {
    throw FormatError("an appearance does not lie on the grid");
  }
  return static_cast<std::uint16_t>(steps);
}

struct Size {
  int width_px;
  int height_px;
};

Size read_size(ByteReader& reader) {
  const auto width_px = static_cast<int>(reader.varint32(INT32_MAX));
  return {width_px, static_cast<int>(reader.varint32(INT32_MAX))};
}

bool has_signature(const Appearance& a) { return a.signature != Signature{}; }

void write_list(ByteWriter& writer, const std::vector<Appearance>& appearances, bool with_signatures) {
  writer.varint(appearances.size());
  std::uint32_t previous = 0;
  for (const Appearance& a : appearances) {
    const std::uint32_t word = to_index(a.word);
    if (word < previous) throw FormatError("appearances are not sorted by word");
    writer.varint(word - previous);
    previous = word;
  }
  for (const Appearance& a : appearances) writer.u16(to_grid(a.x_px, kPositionsPerPixel));
  for (const Appearance& a : appearances) writer.u16(to_grid(a.y_px, kPositionsPerPixel));
  for (const Appearance& a : appearances) writer.u16(to_grid(a.scale_px, kScalesPerPixel));
  for (const Appearance& a : appearances) writer.u16(to_grid(a.angle_deg, kAnglesPerDegree));
  if (!with_signatures) return;
  for (const Appearance& a : appearances) {
    for (const std::uint32_t word : a.signature.bits) writer.u32(word);
  }
}

// The words of a list, handed to `take` in order; returns how many there are.
template <typename Resize, typename Take>
std::uint32_t read_words(ByteReader& reader, Resize&& resize, Take&& take) {
  const std::uint32_t n = reader.varint32(reader.left());
  resize(n);
  std::uint64_t word = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    word += reader.varint();
    if (word > UINT32_MAX) reader.corrupt("a word is too large");
    take(i, WordId{static_cast<std::uint32_t>(word)});
  }
  return n;
}

void read_list(ByteReader& reader, std::vector<Appearance>& appearances) {
  read_words(
      reader, [&](std::uint32_t n) { appearances.resize(n); },
      [&](std::uint32_t i, WordId word) { appearances[i].word = word; });
  for (Appearance& a : appearances) a.x_px = from_grid(reader.u16(), kPositionsPerPixel);
  for (Appearance& a : appearances) a.y_px = from_grid(reader.u16(), kPositionsPerPixel);
  for (Appearance& a : appearances) a.scale_px = from_grid(reader.u16(), kScalesPerPixel);
  for (Appearance& a : appearances) a.angle_deg = from_grid(reader.u16(), kAnglesPerDegree);
  if (reader.version() == kWithoutSignatures) return;
  for (Appearance& a : appearances) {
    for (std::uint32_t& word : a.signature.bits) word = reader.u32();
  }
}

std::uint8_t version_for(const AppearanceVector& image) {
  if (!image.static_appearances.empty()) return kWithStatic;
  return std::ranges::any_of(image.appearances, has_signature) ? kWithSignatures : kWithoutSignatures;
}

}  // namespace

Bytes encode_appearances(const AppearanceVector& image) {
  if (image.width_px < 0 || image.height_px < 0) throw FormatError("an image has a negative size");
  const std::uint8_t version = version_for(image);
  const bool with_signatures = version != kWithoutSignatures;
  ByteWriter writer(kFormat, version);
  writer.reserve(20 + (image.appearances.size() + image.static_appearances.size()) * (with_signatures ? 26 : 10));
  writer.varint(static_cast<std::uint64_t>(image.width_px));
  writer.varint(static_cast<std::uint64_t>(image.height_px));
  write_list(writer, image.appearances, with_signatures);
  if (version == kWithStatic) write_list(writer, image.static_appearances, with_signatures);
  return std::move(writer).finish();
}

AppearanceVector decode_appearances(std::span<const std::uint8_t> blob) {
  ByteReader reader(blob, kFormat, kWithStatic);
  const Size size = read_size(reader);
  AppearanceVector image{size.width_px, size.height_px, {}};
  read_list(reader, image.appearances);
  if (reader.version() == kWithStatic) read_list(reader, image.static_appearances);
  reader.finish();
  return image;
}

void decode_indexed(std::span<const std::uint8_t> blob, IndexedFeatures& features) {
  ByteReader reader(blob, kFormat, kWithStatic);
  read_size(reader);
  const std::uint32_t n = read_words(
      reader, [&](std::uint32_t count) { features.words.resize(count); },
      [&](std::uint32_t i, WordId word) { features.words[i] = word; });
  features.signatures.assign(n, 0);
  if (reader.version() == kWithoutSignatures) return;
  reader.raw(std::size_t{n} * kGridBytes);
  for (VoteSignature& signature : features.signatures) {
    Signature whole;
    for (std::uint32_t& bits : whole.bits) bits = reader.u32();
    signature = vote_signature(whole);
  }
}

}  // namespace mapweld::blobs
