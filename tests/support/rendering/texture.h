// Textures, filtered apart in their two directions.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace mapweld::rendered {

// A picture with its rip-map: level (i, j) is 2^i times coarser across and 2^j times coarser down. Indoor walls, floors
// and ceilings are foreshortened along one texture axis most of the time; filtering that axis alone keeps the other
// sharp, where a mip-map would blur both. Immutable after construction.
class Texture {
 public:
  enum class Edge { kClamped, kTiled };

  // `canvas`: CV_8UC3 (opaque) or CV_8UC4 (alpha 0 is cut out), of any size; kept at the nearest lower powers of two.
  Texture(const cv::Mat& canvas, Edge edge);

  bool tiled() const { return tiled_; }
  bool cut_out() const { return cut_out_; }
  int width() const { return 1 << log2_width_; }
  int height() const { return 1 << log2_height_; }
  int levels_across() const { return log2_width_ + 1; }
  int levels_down() const { return log2_height_ + 1; }

  // Bilinear sample at texture coordinates (u, v), 0..1 over the picture (beyond, if tiled). Returns 0xAARRGGBB.
  // Levels must be valid. Fixed-point arithmetic: the same on every processor.
  std::uint32_t sample(float u, float v, int level_across, int level_down) const {
    const Level& level = levels_[static_cast<std::size_t>(level_across)][static_cast<std::size_t>(level_down)];
    const int width = 1 << level.log2_width;
    const int height = 1 << level.log2_height;
    const int x256 = static_cast<int>(u * static_cast<float>(width << 8)) - 128;
    const int y256 = static_cast<int>(v * static_cast<float>(height << 8)) - 128;
    int x0 = x256 >> 8;
    int y0 = y256 >> 8;
    int x1 = x0 + 1;
    int y1 = y0 + 1;
    if (tiled_) {
      x0 &= width - 1;
      x1 &= width - 1;
      y0 &= height - 1;
      y1 &= height - 1;
    } else {
      x0 = x0 < 0 ? 0 : (x0 >= width ? width - 1 : x0);
      x1 = x1 < 0 ? 0 : (x1 >= width ? width - 1 : x1);
      y0 = y0 < 0 ? 0 : (y0 >= height ? height - 1 : y0);
      y1 = y1 < 0 ? 0 : (y1 >= height ? height - 1 : y1);
    }
    const std::uint32_t* texels = texels_.data() + level.first;
    const std::uint32_t* upper = texels + (static_cast<std::size_t>(y0) << level.log2_width);
    const std::uint32_t* lower = texels + (static_cast<std::size_t>(y1) << level.log2_width);
    const auto fx = static_cast<std::uint32_t>(x256 & 255);
    const auto fy = static_cast<std::uint32_t>(y256 & 255);
    return blend(blend(upper[x0], upper[x1], fx), blend(lower[x0], lower[x1], fx), fy);
  }

 private:
  struct Level {
    std::size_t first = 0;
    int log2_width = 0;
    int log2_height = 0;
  };
  static constexpr int kMaxLevels = 11;

  // Two channels at a time: a + (b - a) * f / 256.
  static std::uint32_t blend(std::uint32_t a, std::uint32_t b, std::uint32_t f) {
    const std::uint32_t even = (((a & 0x00ff00ffU) * (256 - f) + (b & 0x00ff00ffU) * f) >> 8) & 0x00ff00ffU;
    const std::uint32_t odd = (((a >> 8) & 0x00ff00ffU) * (256 - f) + ((b >> 8) & 0x00ff00ffU) * f) & 0xff00ff00U;
    return even | odd;
  }

  int log2_width_ = 0;
  int log2_height_ = 0;
  bool tiled_ = false;
  bool cut_out_ = false;
  std::array<std::array<Level, kMaxLevels>, kMaxLevels> levels_{};
  std::vector<std::uint32_t> texels_;
};

}  // namespace mapweld::rendered
