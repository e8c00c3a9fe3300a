#include "core/feature/exif.h"

#include <cstddef>

#include <opencv2/core.hpp>

namespace mapweld {
namespace {

constexpr std::uint16_t kOrientationTag = 0x0112;
constexpr std::uint16_t kShort = 3;
constexpr std::size_t kEntryBytes = 12;

class TiffReader {
 public:
  TiffReader(std::span<const std::uint8_t> bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  bool holds(std::size_t at, std::size_t count) const { return at <= bytes_.size() && count <= bytes_.size() - at; }

  std::uint32_t number(std::size_t at, int count) const {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) {
      value = value << 8 | bytes_[at + static_cast<std::size_t>(big_endian_ ? i : count - 1 - i)];
    }
    return value;
  }
  std::uint16_t u16(std::size_t at) const { return static_cast<std::uint16_t>(number(at, 2)); }
  std::uint32_t u32(std::size_t at) const { return number(at, 4); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool big_endian_;
};

}  // namespace

int read_exif_orientation(std::span<const std::uint8_t> tiff) {
  if (tiff.size() < 8) return 1;
  const bool big_endian = tiff[0] == 'M' && tiff[1] == 'M';
  if (!big_endian && !(tiff[0] == 'I' && tiff[1] == 'I')) return 1;
  const TiffReader reader(tiff, big_endian);
  if (reader.u16(2) != 42) return 1;

  const std::size_t directory = reader.u32(4);
  if (!reader.holds(directory, 2)) return 1;
  const std::size_t entries = reader.u16(directory);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + i * kEntryBytes;
    if (!reader.holds(entry, kEntryBytes)) return 1;
    if (reader.u16(entry) != kOrientationTag) continue;
    const int value = reader.u16(entry + 8);
    return reader.u16(entry + 2) == kShort && value >= 1 && value <= 8 ? value : 1;
  }
  return 1;
}

cv::Mat upright(const cv::Mat& stored, int orientation) {
  constexpr int kMirrorX = 1;
  constexpr int kMirrorY = 0;
  constexpr int kMirrorBoth = -1;
  cv::Mat turned = stored;
  if (orientation >= 5) cv::transpose(stored, turned);
  cv::Mat result = turned;
  switch (orientation) {
    case 2:
    case 6:
      cv::flip(turned, result, kMirrorX);
      break;
    case 3:
    case 7:
      cv::flip(turned, result, kMirrorBoth);
      break;
    case 4:
    case 8:
      cv::flip(turned, result, kMirrorY);
      break;
    default:
      break;
  }
  return result;
}

}  // namespace mapweld
