#include "tests/support/rendering/texture.h"

#include <algorithm>
#include <stdexcept>

namespace mapweld::rendered {
namespace {

int floor_log2(int value) {
  int log2 = 0;
  while ((2 << log2) <= value) ++log2;
  return log2;
}

// Area average of `count` source pixels onto `size` texels along one axis, in sixteenths of a source pixel.
struct Weight {
  int source;
  int weight;
};
std::vector<std::vector<Weight>> area_weights(int count, int size) {
  std::vector<std::vector<Weight>> weights(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    const int begin = static_cast<int>(static_cast<std::int64_t>(i) * count * 16 / size);
    const int end = static_cast<int>(static_cast<std::int64_t>(i + 1) * count * 16 / size);
    for (int s = begin / 16; s * 16 < end; ++s) {
      weights[static_cast<std::size_t>(i)].push_back({s, std::min(end, (s + 1) * 16) - std::max(begin, s * 16)});
    }
  }
  return weights;
}

std::uint32_t average(std::uint32_t a, std::uint32_t b) {
  std::uint32_t result = 0;
  for (int shift = 0; shift < 32; shift += 8) {
    result |= ((((a >> shift) & 255U) + ((b >> shift) & 255U) + 1) / 2) << shift;
  }
  return result;
}

}  // namespace

Texture::Texture(const cv::Mat& canvas, Edge edge) : tiled_(edge == Edge::kTiled) {
  if (canvas.empty() || (canvas.type() != CV_8UC3 && canvas.type() != CV_8UC4)) {
    throw std::invalid_argument("a texture needs a canvas of 3 or 4 bytes a pixel");
  }
  cut_out_ = canvas.channels() == 4;
  log2_width_ = std::min(floor_log2(canvas.cols), kMaxLevels - 1);
  log2_height_ = std::min(floor_log2(canvas.rows), kMaxLevels - 1);
  const int width = 1 << log2_width_;
  const int height = 1 << log2_height_;

  std::size_t total = 0;
  for (int i = 0; i <= log2_width_; ++i) {
    for (int j = 0; j <= log2_height_; ++j) {
      levels_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = {total, log2_width_ - i, log2_height_ - j};
      total += std::size_t{1} << (log2_width_ - i + log2_height_ - j);
    }
  }
  texels_.resize(total);

  const auto columns = area_weights(canvas.cols, width);
  const auto rows = area_weights(canvas.rows, height);
  const int channels = canvas.channels();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::array<std::int64_t, 4> sum{};
      std::int64_t total_weight = 0;
      for (const Weight& row : rows[static_cast<std::size_t>(y)]) {
        const std::uint8_t* line = canvas.ptr(row.source);
        for (const Weight& column : columns[static_cast<std::size_t>(x)]) {
          const std::int64_t weight = static_cast<std::int64_t>(row.weight) * column.weight;
          total_weight += weight;
          for (int c = 0; c < channels; ++c) {
            sum[static_cast<std::size_t>(c)] += weight * line[column.source * channels + c];
          }
        }
      }
      std::uint32_t texel = cut_out_ ? 0 : 0xff000000U;
      for (int c = 0; c < channels; ++c) {
        texel |= static_cast<std::uint32_t>((sum[static_cast<std::size_t>(c)] + total_weight / 2) / total_weight)
                 << (8 * c);
      }
      texels_[(static_cast<std::size_t>(y) << log2_width_) + static_cast<std::size_t>(x)] = texel;
    }
  }

  for (int i = 0; i <= log2_width_; ++i) {
    for (int j = 0; j <= log2_height_; ++j) {
      if (i == 0 && j == 0) continue;
      const Level& to = levels_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      const bool across = i > 0;
      const Level& from = across ? levels_[static_cast<std::size_t>(i - 1)][static_cast<std::size_t>(j)]
                                 : levels_[0][static_cast<std::size_t>(j - 1)];
      const std::size_t w = std::size_t{1} << to.log2_width;
      const std::size_t h = std::size_t{1} << to.log2_height;
      const std::uint32_t* source = texels_.data() + from.first;
      std::uint32_t* target = texels_.data() + to.first;
      for (std::size_t y = 0; y < h; ++y) {
        for (std::size_t x = 0; x < w; ++x) {
          target[y * w + x] = across ? average(source[y * 2 * w + 2 * x], source[y * 2 * w + 2 * x + 1])
                                     : average(source[2 * y * w + x], source[(2 * y + 1) * w + x]);
        }
      }
    }
  }
}

}  // namespace mapweld::rendered
