// A file that should be an image: refused, or a grey image of the size that its header says, within the bounds.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "core/errors.h"
#include "core/feature/decode.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mapweld;
  const DecodeOptions options{.max_pixels = 100'000, .max_side_px = 1'000};
  const std::span bytes(data, size);
  try {
    const DecodedImage image = decode_image(bytes, options);
    const ImageHeader header = read_image_header(bytes);
    const bool upright = image.grey.cols == header.width_px && image.grey.rows == header.height_px;
    const bool turned = image.grey.cols == header.height_px && image.grey.rows == header.width_px;
    if (image.grey.type() != CV_8UC1 || !(upright || turned)) std::abort();
    if (std::int64_t{image.grey.cols} * image.grey.rows > options.max_pixels) std::abort();
    if (!image.used.empty() && image.used.size() != image.grey.size()) std::abort();
  } catch (const ImageError&) {
  }
  return 0;
}
