// JPEG to grey pixels by libjpeg-turbo, strict where imdecode is lenient: a file cut short or corrupt is an error, not
// a picture that fades into grey.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <opencv2/core/mat.hpp>

namespace mapweld {

// One image, read once: header first, so that its size can be judged before its pixels cost anything.
class JpegReader {
 public:
  // Reads the header. `bytes` must outlive the reader. Throws ImageError undecodable_image.
  explicit JpegReader(std::span<const std::uint8_t> bytes);
  ~JpegReader();
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  int width_px() const;
  int height_px() const;
  int orientation() const;  // EXIF, 1..8

  // Luma as stored (BT.601's Y), CMYK converted; CV_8UC1, orientation not applied. Call once. Bytes after the end of
  // the image are ignored. Throws ImageError undecodable_image.
  cv::Mat read_grey();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mapweld
