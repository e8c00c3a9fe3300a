#include "core/feature/png.h"

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <png.h>

#include "core/errors.h"
#include "core/feature/exif.h"

namespace mapweld {
namespace {

constexpr png_uint_32 kPixelChunk = 0x49444154;  // "IDAT"

// Compressed bytes that may follow the last row within the stream of pixels: its checksum and what encoders leave. The
// library inflates whatever is there, a thousand times as much, while it reads the last row.
constexpr std::size_t kMaxBytesAfterRows = 16 * 1024;

// Frames that setjmp returns to hold nothing with a destructor; what needs one lives here.
struct Reader {
  std::span<const std::uint8_t> rest;
  int passes = 1;
  std::size_t pixel_bytes_left = SIZE_MAX;  // that the stream of pixels may still have
  char message[256] = "";
  png_structp codec = nullptr;
  png_infop info = nullptr;

  explicit Reader(std::span<const std::uint8_t> bytes) : rest(bytes) {
    codec = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (codec != nullptr) info = png_create_info_struct(codec);
    if (info == nullptr) {
      png_destroy_read_struct(&codec, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(codec, this, on_read);
  }
  ~Reader() { png_destroy_read_struct(&codec, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  [[noreturn]] static void on_error(png_structp codec, png_const_charp text) {
    auto* self = static_cast<Reader*>(png_get_error_ptr(codec));
    std::snprintf(self->message, sizeof self->message, "%s", text);
    png_longjmp(codec, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_read(png_structp codec, png_bytep out, std::size_t count) {
    auto* self = static_cast<Reader*>(png_get_io_ptr(codec));
    if (count > self->rest.size()) png_error(codec, "the file ends too early");
    if (png_get_io_chunk_type(codec) == kPixelChunk) {
      if (count > self->pixel_bytes_left) png_error(codec, "the pixels go on after the last row");
      self->pixel_bytes_left -= count;
    }
    std::memcpy(out, self->rest.data(), count);
    self->rest = self->rest.subspan(count);
  }

  bool read_header() {
    if (setjmp(png_jmpbuf(codec)) != 0) return false;
    // Texts, profiles and the like are passed over: each may inflate to megabytes, and there may be any number.
    png_set_keep_unknown_chunks(codec, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_keep_unknown_chunks(codec, PNG_HANDLE_CHUNK_AS_DEFAULT, reinterpret_cast<png_const_bytep>("eXIf"), 1);
    png_read_info(codec, info);
    const int colour = png_get_color_type(codec, info);
    const int depth = png_get_bit_depth(codec, info);
    if (depth == 16 && std::endian::native == std::endian::little) png_set_swap(codec);
    if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(codec);
    if (colour == PNG_COLOR_TYPE_GRAY && depth < 8) png_set_expand_gray_1_2_4_to_8(codec);
    if (png_get_valid(codec, info, PNG_INFO_tRNS) != 0) png_set_tRNS_to_alpha(codec);
    passes = png_set_interlace_handling(codec);
    png_read_update_info(codec, info);
    return true;
  }

  bool read_pixels(png_bytepp rows, png_uint_32 height) {
    if (setjmp(png_jmpbuf(codec)) != 0) return false;
    for (int pass = 0; pass < passes; ++pass) {
      for (png_uint_32 y = 0; y < height; ++y) {
        // Of an interlaced image's last pass the last row but one may be the last that holds pixels.
        if (pass == passes - 1 && (y + 2 == height || height == 1)) {
          pixel_bytes_left = 2 * png_get_rowbytes(codec, info) + kMaxBytesAfterRows;
        }
        png_read_row(codec, rows[y], nullptr);
      }
    }
    png_read_end(codec, info);
    return true;
  }

  [[noreturn]] void fail() const { throw ImageError("undecodable_image", std::string("PNG: ") + message); }
};

cv::Mat grey_of(const cv::Mat& pixels) {
  cv::Mat grey;
  switch (pixels.channels()) {
    case 1:
      return pixels;
    case 2:
      cv::extractChannel(pixels, grey, 0);
      return grey;
    case 3:
      cv::cvtColor(pixels, grey, cv::COLOR_RGB2GRAY);
      return grey;
    default:
      cv::cvtColor(pixels, grey, cv::COLOR_RGBA2GRAY);
      return grey;
  }
}

// Empty where nothing is wholly transparent.
cv::Mat used_of(const cv::Mat& pixels) {
  const int channels = pixels.channels();
  if (channels != 2 && channels != 4) return {};
  cv::Mat alpha;
  cv::extractChannel(pixels, alpha, channels - 1);
  cv::Mat used = alpha != 0;
  return cv::countNonZero(used) == static_cast<int>(used.total()) ? cv::Mat() : used;
}

}  // namespace

PngImage read_png_grey(std::span<const std::uint8_t> bytes) {
  Reader reader(bytes);
  if (!reader.read_header()) reader.fail();

  const auto width = static_cast<int>(png_get_image_width(reader.codec, reader.info));
  const auto height = static_cast<int>(png_get_image_height(reader.codec, reader.info));
  const int channels = png_get_channels(reader.codec, reader.info);
  const int depth = png_get_bit_depth(reader.codec, reader.info) == 16 ? CV_16U : CV_8U;
  cv::Mat pixels(height, width, CV_MAKETYPE(depth, channels));
  if (png_get_rowbytes(reader.codec, reader.info) > pixels.step[0] || channels > 4) {
    throw ImageError("undecodable_image", "PNG: unexpected layout of pixels");
  }
  std::vector<png_bytep> rows(static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) rows[static_cast<std::size_t>(y)] = pixels.ptr(y);
  if (!reader.read_pixels(rows.data(), static_cast<png_uint_32>(height))) reader.fail();

  PngImage image{.grey = grey_of(pixels), .used = used_of(pixels)};
  png_bytep exif = nullptr;
  png_uint_32 exif_bytes = 0;
  if (png_get_eXIf_1(reader.codec, reader.info, &exif_bytes, &exif) != 0) {
    image.orientation = read_exif_orientation({exif, exif_bytes});
  }
  return image;
}

}  // namespace mapweld
