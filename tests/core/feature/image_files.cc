#include "tests/core/feature/image_files.h"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
// libjpeg's header needs <cstdio> before it.
#include <jpeglib.h>

#include "core/random.h"

namespace mapweld::test {
namespace {

void append(Bytes& bytes, std::span<const std::uint8_t> more) {
  for (const std::uint8_t byte : more) bytes.push_back(byte);
}

void append_big_endian(Bytes& bytes, std::uint32_t value, int count) {
  for (int i = count; i-- > 0;) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

Bytes inserted(const Bytes& file, std::size_t at, const Bytes& piece) {
  Bytes out(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(at));
  append(out, piece);
  out.insert(out.end(), file.begin() + static_cast<std::ptrdiff_t>(at), file.end());
  return out;
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

constexpr std::size_t kBehindPngHeader = 8 + 12 + 13;

}  // namespace

cv::Mat textured_image(int width_px, int height_px, std::uint64_t seed) {
  cv::Mat image(height_px, width_px, CV_8UC3, cv::Scalar(120, 130, 140));
  SplitMix64 random(seed);
  const int blobs = std::max(1, width_px * height_px / 250);
  for (int i = 0; i < blobs; ++i) {
    const cv::Point centre(static_cast<int>(random.below(static_cast<std::uint64_t>(width_px))),
                           static_cast<int>(random.below(static_cast<std::uint64_t>(height_px))));
    const cv::Scalar colour(static_cast<double>(random.below(256)), static_cast<double>(random.below(256)),
                            static_cast<double>(random.below(256)));
    cv::circle(image, centre, 2 + static_cast<int>(random.below(9)), colour, cv::FILLED, cv::LINE_AA);
  }
  cv::GaussianBlur(image, image, {}, 0.8);
  return image;
}

Bytes encode(std::string_view ending, const cv::Mat& image, const std::vector<int>& parameters) {
  Bytes bytes;
  if (!cv::imencode(std::string(ending), image, bytes, parameters)) throw std::runtime_error("imencode failed");
  return bytes;
}

Bytes encode_jpeg(const cv::Mat& bgr, const JpegLayout& layout) {
  const bool inks = layout.colours == JpegColours::kCmyk || layout.colours == JpegColours::kYcck;
  const std::size_t channels = inks ? 4 : 3;
  jpeg_compress_struct codec{};
  jpeg_error_mgr errors{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_compress(&codec);
  unsigned char* file = nullptr;
  unsigned long file_bytes = 0;
  jpeg_mem_dest(&codec, &file, &file_bytes);
  codec.image_width = static_cast<JDIMENSION>(bgr.cols);
  codec.image_height = static_cast<JDIMENSION>(bgr.rows);
  codec.input_components = static_cast<int>(channels);
  codec.in_color_space = inks ? JCS_CMYK : JCS_RGB;
  jpeg_set_defaults(&codec);
  switch (layout.colours) {
    case JpegColours::kYcc:
      jpeg_set_colorspace(&codec, JCS_YCbCr);
      break;
    case JpegColours::kRgb:
      jpeg_set_colorspace(&codec, JCS_RGB);
      break;
    case JpegColours::kCmyk:
      jpeg_set_colorspace(&codec, JCS_CMYK);
      break;
    case JpegColours::kYcck:
      jpeg_set_colorspace(&codec, JCS_YCCK);
      break;
  }
  jpeg_set_quality(&codec, 100, TRUE);
  for (int i = 0; i < codec.num_components; ++i) {
    codec.comp_info[i].h_samp_factor = 1;
    codec.comp_info[i].v_samp_factor = 1;
  }
  codec.arith_code = layout.arithmetic ? TRUE : FALSE;
  codec.restart_in_rows = static_cast<int>(layout.restart_rows);
  if (layout.progressive) jpeg_simple_progression(&codec);
  std::vector<jpeg_scan_info> script;
  if (layout.scans > 0) {
    script.push_back(
        {.comps_in_scan = codec.num_components, .component_index = {0, 1, 2, 3}, .Ss = 0, .Se = 0, .Ah = 0, .Al = 0});
    for (int i = 1; i < layout.scans; ++i) {
      script.push_back({.comps_in_scan = 1, .component_index = {0, 0, 0, 0}, .Ss = i, .Se = i, .Ah = 0, .Al = 0});
    }
    codec.scan_info = script.data();
    codec.num_scans = layout.scans;
  }
  jpeg_start_compress(&codec, TRUE);
  Bytes row(static_cast<std::size_t>(bgr.cols) * channels);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      const auto& pixel = bgr.at<cv::Vec3b>(y, x);
      const auto at = static_cast<std::size_t>(x) * channels;
      row[at] = pixel[2];
      row[at + 1] = pixel[1];
      row[at + 2] = pixel[0];
      if (inks) row[at + 3] = 255;
    }
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&codec, rows, 1);
  }
  jpeg_finish_compress(&codec);
  jpeg_destroy_compress(&codec);
  Bytes bytes(file, file + file_bytes);
  std::free(file);
  return bytes;
}

Bytes exif_block(int orientation, bool big_endian) {
  const auto value = static_cast<std::uint8_t>(orientation);
  if (big_endian) {
    return {'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 0x01, 0x12, 0, 3, 0, 0, 0, 1, 0, value, 0, 0, 0, 0, 0, 0};
  }
  return {'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 0x12, 0x01, 3, 0, 1, 0, 0, 0, value, 0, 0, 0, 0, 0, 0, 0};
}

Bytes with_jpeg_exif(const Bytes& jpeg, const Bytes& exif) {
  Bytes segment{0xFF, 0xE1};
  append_big_endian(segment, static_cast<std::uint32_t>(2 + 6 + exif.size()), 2);
  append(segment, Bytes{'E', 'x', 'i', 'f', 0, 0});
  append(segment, exif);
  return inserted(jpeg, 2, segment);
}

Bytes with_png_exif(const Bytes& png, const Bytes& exif) { return with_png_chunk(png, png_chunk("eXIf", exif)); }

Bytes png_chunk(std::string_view type, std::span<const std::uint8_t> data) {
  Bytes named(type.begin(), type.end());
  append(named, data);
  Bytes chunk;
  append_big_endian(chunk, static_cast<std::uint32_t>(data.size()), 4);
  append(chunk, named);
  append_big_endian(chunk, crc32(named), 4);
  return chunk;
}

Bytes with_png_chunk(const Bytes& png, const Bytes& chunk) { return inserted(png, kBehindPngHeader, chunk); }

Bytes png_claiming(std::uint32_t width_px, std::uint32_t height_px) {
  Bytes bytes{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  Bytes header;
  append_big_endian(header, width_px, 4);
  append_big_endian(header, height_px, 4);
  append(header, Bytes{8, 0, 0, 0, 0});
  append(bytes, png_chunk("IHDR", header));
  append(bytes, png_chunk("IEND", {}));
  return bytes;
}

Bytes jpeg_claiming(const Bytes& jpeg, std::uint16_t width_px, std::uint16_t height_px) {
  Bytes bytes = jpeg;
  for (std::size_t at = 2; at + 9 < bytes.size();) {
    const std::uint8_t marker = bytes[at + 1];
    if (marker >= 0xC0 && marker <= 0xC2) {
      bytes[at + 5] = static_cast<std::uint8_t>(height_px >> 8);
      bytes[at + 6] = static_cast<std::uint8_t>(height_px);
      bytes[at + 7] = static_cast<std::uint8_t>(width_px >> 8);
      bytes[at + 8] = static_cast<std::uint8_t>(width_px);
      return bytes;
    }
    at += 2 + (std::size_t{bytes[at + 2]} << 8 | bytes[at + 3]);
  }
  throw std::runtime_error("no frame header");
}

}  // namespace mapweld::test
