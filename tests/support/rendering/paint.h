// Brushes for procedural textures, on top of OpenCV's integer drawing functions.
#pragma once

#include <cstdint>
#include <string>

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

// Smooth noise in [-1, 1] on a lattice that wraps round after `across` x `down` cells.
double value_noise(double x, double y, int across, int down, std::uint64_t seed);
// Adds `amplitude` grey levels of noise with cells of `cell_px` and an octave finer. Tiles seamlessly.
void add_noise(cv::Mat& canvas, double cell_px, double amplitude, std::uint64_t seed);

std::string made_up_word(Random& random);

}  // namespace mapweld::rendered
