// Where the bytes of strangers become pixels.
#pragma once

#include <cstdint>
#include <span>

#include "core/feature/decode.h"

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
};

// In this process.
class LocalDecoder final : public ImageDecoder {
 public:
  DecodedImage decode(std::span<const std::uint8_t> bytes, bool stretch) override {
    return decode_image(bytes, {.stretch = stretch});
  }
};

}  // namespace mapweld::server
