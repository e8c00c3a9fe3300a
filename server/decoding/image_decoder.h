// Where the bytes of strangers become pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/feature/decode.h"
#include "core/feature/shrink.h"

namespace mapweld::server {

// Thread-safe.
class ImageDecoder {
 public:
  ImageDecoder() = default;
  virtual ~ImageDecoder() = default;
  ImageDecoder(const ImageDecoder&) = delete;
  ImageDecoder& operator=(const ImageDecoder&) = delete;

  // As decode_image(bytes, {.stretch = stretch}), to the pixel, with the same ImageErrors.
  virtual DecodedImage decode(std::span<const std::uint8_t> bytes, bool stretch) = 0;
  // As shrink_image(bytes, width_px), to the byte, with the same ImageErrors.
  virtual std::vector<std::uint8_t> shrink(std::span<const std::uint8_t> bytes, int width_px) = 0;
};

// In this process.
class LocalDecoder final : public ImageDecoder {
 public:
  DecodedImage decode(std::span<const std::uint8_t> bytes, bool stretch) override {
    return decode_image(bytes, {.stretch = stretch});
  }
  std::vector<std::uint8_t> shrink(std::span<const std::uint8_t> bytes, int width_px) override {
    return shrink_image(bytes, width_px);
  }
};

}  // namespace mapweld::server
