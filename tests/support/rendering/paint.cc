#include "tests/support/rendering/paint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace mapweld::rendered {

Hsv::operator Colour() const {
  const double h = wrap_deg(hue_deg) / 60;
  const int sector = static_cast<int>(h);
  const double f = h - sector;
  const double v = 255 * value;
  const double p = v * (1 - saturation);
  const double q = v * (1 - saturation * f);
  const double t = v * (1 - saturation * (1 - f));
  switch (sector) {
    case 0:
      return rgb(v, t, p);
    case 1:
      return rgb(q, v, p);
    case 2:
      return rgb(p, v, t);
    case 3:
      return rgb(p, q, v);
    case 4:
      return rgb(t, p, v);
    default:
      return rgb(v, p, q);
  }
}

Colour any_colour(Random& random) {
  const double hue = random.uniform(0, 360);
  const double saturation = random.uniform(0.15, 0.9);
  return Hsv{hue, saturation, random.uniform(0.2, 0.98)};
}

Colour scaled(const Colour& colour, double factor) {
  return {std::min(255.0, colour[0] * factor), std::min(255.0, colour[1] * factor), std::min(255.0, colour[2] * factor),
          255};
}

cv::Mat canvas(int width, int height, const Colour& colour) { return {height, width, CV_8UC3, colour}; }

cv::Mat clear_canvas(int width, int height, const Colour& colour) {
  return {height, width, CV_8UC4, Colour(colour[0], colour[1], colour[2], 0)};
}

namespace {
constexpr int kShift = 4;  // sixteenths of a pixel
int fixed(double value) { return static_cast<int>(std::lround(value * (1 << kShift))); }
}  // namespace

void fill(cv::Mat& canvas, double x, double y, double width, double height, const Colour& colour) {
  if (width <= 0 || height <= 0) return;
  const cv::Point from(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)));
  const cv::Point to(std::max(from.x, static_cast<int>(std::lround(x + width)) - 1),
                     std::max(from.y, static_cast<int>(std::lround(y + height)) - 1));
  cv::rectangle(canvas, from, to, colour, cv::FILLED);
}

void outline(cv::Mat& canvas, double x, double y, double width, double height, const Colour& colour, int thickness) {
  const double t = thickness;
  fill(canvas, x, y, width, t, colour);
  fill(canvas, x, y + height - t, width, t, colour);
  fill(canvas, x, y, t, height, colour);
  fill(canvas, x + width - t, y, t, height, colour);
}

void disc(cv::Mat& canvas, double x, double y, double radius, const Colour& colour, int thickness) {
  cv::circle(canvas, {fixed(x), fixed(y)}, std::max(1, fixed(radius)), colour, thickness, cv::LINE_AA, kShift);
}

void stroke(cv::Mat& canvas, double x0, double y0, double x1, double y1, const Colour& colour, int thickness) {
  cv::line(canvas, {fixed(x0), fixed(y0)}, {fixed(x1), fixed(y1)}, colour, thickness, cv::LINE_AA, kShift);
}

void vertical_gradient(cv::Mat& canvas, const Colour& top, const Colour& bottom) {
  for (int y = 0; y < canvas.rows; ++y) {
    const double t = (y + 0.5) / canvas.rows;
    fill(
        canvas, 0, y, canvas.cols, 1,
        {top[0] + (bottom[0] - top[0]) * t, top[1] + (bottom[1] - top[1]) * t, top[2] + (bottom[2] - top[2]) * t, 255});
  }
}

void random_gradient(cv::Mat& canvas, Random& random) {
  const Colour top = any_colour(random);
  vertical_gradient(canvas, top, any_colour(random));
}

void text(cv::Mat& canvas, const std::string& words, double x, double y, double height, const Colour& colour,
          int thickness) {
  // Capitals of this font are 21 units high at scale 1.
  cv::putText(canvas, words, {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))},
              cv::FONT_HERSHEY_DUPLEX, height / 21.0, colour, thickness, cv::LINE_AA);
}

void print_lines(cv::Mat& canvas, double x, double y, double width, double height, double line, const Colour& colour,
                 Random& random) {
  for (double row = y; row + line * 0.6 <= y + height; row += line) {
    const double end = random.chance(0.2) ? x + width * random.uniform(0.3, 0.9) : x + width;
    double at = x;
    while (at < end) {
      const double word = std::min(line * random.uniform(0.6, 3.2), end - at);
      const double weight = random.uniform(0.35, 0.6);
      fill(canvas, at, row + line * (0.6 - weight) * 0.5, word, std::max(1.0, line * weight), colour);
      at += word + line * 0.5;
    }
  }
}

NoiseField::NoiseField(int across, int down, std::uint64_t seed) : across_(across), down_(down) {
  lattice_.reserve(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      const std::uint64_t bits = mix(seed ^ (static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint64_t>(j)));
      lattice_.push_back(static_cast<double>(bits >> 11) * 0x1.0p-52 - 1);
    }
  }
}

void add_noise(cv::Mat& canvas, double cell_px, double amplitude, std::uint64_t seed) {
  const int channels = canvas.channels();
  // Whole numbers of cells across and down, so that the picture tiles.
  const int across = std::max(1, static_cast<int>(std::lround(canvas.cols / cell_px)));
  const int down = std::max(1, static_cast<int>(std::lround(canvas.rows / cell_px)));
  const NoiseField coarse(across, down, seed);
  const NoiseField fine(2 * across, 2 * down, seed + 1);
  for (int y = 0; y < canvas.rows; ++y) {
    std::uint8_t* row = canvas.ptr(y);
    const double v = static_cast<double>(y) * down / canvas.rows;
    for (int x = 0; x < canvas.cols; ++x) {
      const double u = static_cast<double>(x) * across / canvas.cols;
      const double value = amplitude * (0.6 * coarse.at(u, v) + 0.4 * fine.at(2 * u, 2 * v));
      const int delta = static_cast<int>(value + 1024.5) - 1024;
      for (int c = 0; c < 3; ++c) {
        std::uint8_t& pixel = row[x * channels + c];
        pixel = static_cast<std::uint8_t>(std::clamp(static_cast<int>(pixel) + delta, 0, 255));
      }
    }
  }
}

std::string made_up_word(Random& random) {
  static constexpr std::array<const char*, 24> kSyllables{"MA",  "RO",  "TE",  "LI",  "KAN", "SOL", "VER", "DO",
                                                          "PHI", "NEX", "TUR", "GAL", "BE",  "SI",  "ORA", "MUN",
                                                          "ZE",  "LAB", "CO",  "WEN", "HAR", "QUI", "DEX", "UM"};
  std::string word;
  const int syllables = random.between(2, 3);
  for (int i = 0; i < syllables; ++i) {
    word += kSyllables[static_cast<std::size_t>(random.below(static_cast<int>(kSyllables.size())))];
  }
  return word;
}

}  // namespace mapweld::rendered
