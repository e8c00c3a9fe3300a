#include "core/feature/jpeg.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
// libjpeg's headers need <cstdio> before them.
#include <jpeglib.h>
// and this one the above
#include <jerror.h>

#include "core/errors.h"
#include "core/feature/exif.h"

namespace mapweld {
namespace {

// A progressive file may hold thousands of scans, each a pass over the whole image. Encoders write 10 to 20, and some
// that search for the smallest file up to 64.
constexpr std::int64_t kMaxScans = 100;
constexpr std::int64_t kMaxPixelScans = 400'000'000;  // pixels times scans, where the scans are more than:
constexpr std::int64_t kAlwaysScans = 20;

std::int64_t max_scans(std::int64_t pixels) {
  return std::clamp(kMaxPixelScans / std::max<std::int64_t>(pixels, 1), kAlwaysScans, kMaxScans);
}

constexpr std::array<std::uint8_t, 6> kExifPrefix = {'E', 'x', 'i', 'f', 0, 0};

struct ErrorManager {
  jpeg_error_mgr base;  // first: libjpeg hands back a pointer to it
  std::jmp_buf escape;
  char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void on_error(j_common_ptr codec) {
  auto* errors = reinterpret_cast<ErrorManager*>(codec->err);
  codec->err->format_message(codec, errors->message);
  std::longjmp(errors->escape, 1);
}

void on_message(j_common_ptr codec, int level) {
  if (level >= 0) return;  // a trace
  switch (codec->err->msg_code) {
    case JWRN_JPEG_EOF:
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_ARITH_BAD_CODE:
    case JWRN_MUST_RESYNC:
    case JWRN_BOGUS_PROGRESSION:
      on_error(codec);
    default:
      break;  // oddities that lose no pixel
  }
}

void on_output(j_common_ptr) {}

void on_progress(j_common_ptr codec) {
  auto* decompressor = reinterpret_cast<j_decompress_ptr>(codec);
  if (decompressor->input_scan_number >
      max_scans(std::int64_t{decompressor->image_width} * decompressor->image_height)) {
    ERREXIT(decompressor, JERR_BAD_PROGRESSION);
  }
}

}  // namespace

struct JpegReader::State {
  jpeg_decompress_struct codec{};
  ErrorManager errors{};
  jpeg_progress_mgr progress{};
  int orientation = 1;

  // Frames that setjmp returns to hold nothing with a destructor.
  bool read_header(const std::uint8_t* bytes, std::size_t size) {
    if (setjmp(errors.escape) != 0) return false;
    jpeg_mem_src(&codec, bytes, size);
    jpeg_save_markers(&codec, JPEG_APP0 + 1, 0xFFFF);
    jpeg_read_header(&codec, TRUE);
    return true;
  }

  bool read_pixels(std::uint8_t* pixels, std::size_t stride) {
    if (setjmp(errors.escape) != 0) return false;
    const bool cmyk = codec.jpeg_color_space == JCS_CMYK || codec.jpeg_color_space == JCS_YCCK;
    codec.out_color_space = cmyk ? JCS_CMYK : JCS_GRAYSCALE;
    codec.dct_method = JDCT_ISLOW;  // the same pixels with and without SIMD
    jpeg_start_decompress(&codec);
    JSAMPARRAY inks = nullptr;
    if (cmyk) {
      inks = codec.mem->alloc_sarray(reinterpret_cast<j_common_ptr>(&codec), JPOOL_IMAGE, codec.output_width * 4, 1);
    }
    while (codec.output_scanline < codec.output_height) {
      JSAMPROW row = pixels + codec.output_scanline * stride;
      if (cmyk) {
        jpeg_read_scanlines(&codec, inks, 1);
        grey_from_inks(inks[0], row, codec.output_width, codec.saw_Adobe_marker);
      } else {
        jpeg_read_scanlines(&codec, &row, 1);
      }
    }
    jpeg_finish_decompress(&codec);
    return true;
  }

  // Adobe stores inks inverted, 255 for none.
  static void grey_from_inks(const std::uint8_t* inks, std::uint8_t* grey, std::size_t width, bool inverted) {
    for (std::size_t x = 0; x < width; ++x) {
      std::array<int, 4> light;
      for (std::size_t i = 0; i < 4; ++i) light[i] = inverted ? inks[4 * x + i] : 255 - inks[4 * x + i];
      const int luma = 299 * light[0] + 587 * light[1] + 114 * light[2];
      grey[x] = static_cast<std::uint8_t>((luma * light[3] + 127'500) / 255'000);
    }
  }

  [[noreturn]] void fail() const { throw ImageError("undecodable_image", std::string("JPEG: ") + errors.message); }
};

JpegReader::JpegReader(std::span<const std::uint8_t> bytes) : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.codec.err = jpeg_std_error(&state.errors.base);
  state.errors.base.error_exit = on_error;
  state.errors.base.emit_message = on_message;
  state.errors.base.output_message = on_output;
  jpeg_create_decompress(&state.codec);
  state.progress.progress_monitor = on_progress;
  state.codec.progress = &state.progress;

  if (!state.read_header(bytes.data(), bytes.size())) {
    jpeg_destroy_decompress(&state.codec);
    state.fail();
  }
  for (const jpeg_marker_struct* marker = state.codec.marker_list; marker != nullptr; marker = marker->next) {
    const std::span<const std::uint8_t> data(marker->data, marker->data_length);
    if (data.size() >= kExifPrefix.size() && std::equal(kExifPrefix.begin(), kExifPrefix.end(), data.begin())) {
      state.orientation = read_exif_orientation(data.subspan(kExifPrefix.size()));
      break;
    }
  }
}

JpegReader::~JpegReader() { jpeg_destroy_decompress(&state_->codec); }

int JpegReader::width_px() const { return static_cast<int>(state_->codec.image_width); }
int JpegReader::height_px() const { return static_cast<int>(state_->codec.image_height); }
int JpegReader::orientation() const { return state_->orientation; }

cv::Mat JpegReader::read_grey() {
  cv::Mat grey(height_px(), width_px(), CV_8UC1);
  if (!state_->read_pixels(grey.data, grey.step[0])) state_->fail();
  return grey;
}

}  // namespace mapweld
