// Brushes for procedural textures, on top of OpenCV's integer drawing functions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {

using Colour = cv::Scalar;
inline Colour rgb(double red, double green, double blue) { return {blue, green, red, 255}; }
// A colour by hue, saturation and value (0..1). Braces, unlike a call's arguments, are evaluated from left to right.
struct Hsv {
  double hue_deg;
  double saturation;
  double value;
  operator Colour() const;  // NOLINT(google-explicit-constructor): it is a colour
};
Colour any_colour(Random& random);
Colour scaled(const Colour& colour, double factor);

cv::Mat canvas(int width, int height, const Colour& colour);
cv::Mat clear_canvas(int width, int height, const Colour& colour);  // alpha 0 everywhere

void fill(cv::Mat& canvas, double x, double y, double width, double height, const Colour& colour);
void outline(cv::Mat& canvas, double x, double y, double width, double height, const Colour& colour, int thickness);
void disc(cv::Mat& canvas, double x, double y, double radius, const Colour& colour, int thickness = -1);
void stroke(cv::Mat& canvas, double x0, double y0, double x1, double y1, const Colour& colour, int thickness);
void vertical_gradient(cv::Mat& canvas, const Colour& top, const Colour& bottom);
void random_gradient(cv::Mat& canvas, Random& random);
// Text whose capitals are `height` pixels high, its base line at y.
void text(cv::Mat& canvas, const std::string& words, double x, double y, double height, const Colour& colour,
          int thickness = 1);
// Lines of grey words, as print looks from afar.
void print_lines(cv::Mat& canvas, double x, double y, double width, double height, double line, const Colour& colour,
                 Random& random);

// Smooth noise in [-1, 1] on a lattice of `across` x `down` cells that wraps round. x, y > -1.
class NoiseField {
 public:
  NoiseField(int across, int down, std::uint64_t seed);
  double at(double x, double y) const {
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    const int x0 = column % across_;
    const int y0 = row % down_;
    const int x1 = x0 + 1 == across_ ? 0 : x0 + 1;
    const int y1 = y0 + 1 == down_ ? 0 : y0 + 1;
    double tx = x - column;
    double ty = y - row;
    tx = tx * tx * (3 - 2 * tx);
    ty = ty * ty * (3 - 2 * ty);
    const double upper = lattice(x0, y0) * (1 - tx) + lattice(x1, y0) * tx;
    const double lower = lattice(x0, y1) * (1 - tx) + lattice(x1, y1) * tx;
    return upper * (1 - ty) + lower * ty;
  }

 private:
  double lattice(int x, int y) const { return lattice_[static_cast<std::size_t>(y * across_ + x)]; }
  int across_;
  int down_;
  std::vector<double> lattice_;
};
// Adds `amplitude` grey levels of noise with cells of `cell_px` and an octave finer. Tiles seamlessly.
void add_noise(cv::Mat& canvas, double cell_px, double amplitude, std::uint64_t seed);

std::string made_up_word(Random& random);

}  // namespace mapweld::rendered
