// Smaller pictures of image files, to look at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/feature/decode.h"

namespace mapweld {

// The picture as a file of the same format, at most `width_px` (> 0) wide, never larger than it is, its aspect kept and
// upright (EXIF orientation applied): colour and transparency as they are, 8 bits a sample. Empty: the file is that
// already. Thread-safe. Throws ImageError as decode_image.
std::vector<std::uint8_t> shrink_image(std::span<const std::uint8_t> bytes, int width_px,
                                       const DecodeOptions& options = {});

}  // namespace mapweld
