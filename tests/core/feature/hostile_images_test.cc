// Files that are small and ask for much: what decoding costs is bounded by the pixels and the bytes of the file.
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

#include "core/errors.h"
#include "core/feature/decode.h"
#include "tests/core/feature/image_files.h"

namespace mapweld {
namespace {

using test::Bytes;

std::string message_of(const Bytes& file) {
  try {
    decode_image(file);
    return "decoded";
  } catch (const ImageError& error) {
    return error.code() + ": " + error.what();
  }
}

Bytes deflated(std::size_t bytes, std::uint8_t value) {
  const Bytes raw(bytes, value);
  Bytes out(compressBound(raw.size()));
  uLongf size = out.size();
  EXPECT_EQ(compress2(out.data(), &size, raw.data(), raw.size(), 9), Z_OK);
  out.resize(size);
  return out;
}

// 64 x 64 grey pixels, all black, and `more` bytes behind the last row in the same stream.
Bytes png_that_runs_on(std::size_t more) {
  const Bytes empty = test::png_claiming(64, 64);
  const auto append = [](Bytes& to, const Bytes& from) { to.insert(to.end(), from.begin(), from.end()); };
  Bytes file(empty.begin(), empty.begin() + 8);
  append(file, test::png_chunk("IHDR", Bytes{0, 0, 0, 64, 0, 0, 0, 64, 8, 0, 0, 0, 0}));
  append(file, test::png_chunk("IDAT", deflated(64 * 65 + more, 0)));
  append(file, test::png_chunk("IEND", {}));
  return file;
}

std::size_t peak_resident_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoul(line.substr(6));
  }
  return 0;
}

TEST(HostilePng, AStreamThatRunsOnAfterTheLastRowIsRefused) {
  EXPECT_EQ(message_of(png_that_runs_on(0)), "decoded");
  EXPECT_EQ(message_of(png_that_runs_on(100)), "decoded") << "padding that some encoders leave";
  EXPECT_EQ(message_of(png_that_runs_on(64 << 20)), "undecodable_image: PNG: the pixels go on after the last row");
}

// Each text inflates to 7 MB.
TEST(HostilePng, TextsAreNotInflated) {
  const Bytes text = deflated(7 << 20, 'a');
  Bytes data = {'a', 0, 0};
  data.insert(data.end(), text.begin(), text.end());
  const Bytes chunk = test::png_chunk("zTXt", data);
  Bytes chunks;
  for (int i = 0; i < 200; ++i) chunks.insert(chunks.end(), chunk.begin(), chunk.end());
  const Bytes file = test::with_png_chunk(test::encode(".png", test::textured_image(96, 64)), chunks);
  const std::size_t before_kb = peak_resident_kb();
  EXPECT_EQ(message_of(file), "decoded");
  EXPECT_LT(peak_resident_kb(), before_kb + 200 * 1024);
}

// A scan of a progressive file costs a pass over all its pixels, however few bytes it has.
TEST(HostileJpeg, ALargeImageMayHaveFewerScans) {
  const auto jpeg_of = [](int width_px, int height_px, int scans) {
    return test::encode_jpeg(cv::Mat(height_px, width_px, CV_8UC3, cv::Scalar(90, 120, 150)),
                             {.progressive = true, .scans = scans});
  };
  EXPECT_EQ(message_of(jpeg_of(640, 480, 60)), "decoded");
  EXPECT_EQ(message_of(jpeg_of(4000, 3900, 18)), "decoded");
  EXPECT_TRUE(message_of(jpeg_of(4000, 3900, 60)).starts_with("undecodable_image: JPEG")) << "25 are allowed";
}

}  // namespace
}  // namespace mapweld
