#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/rendering/paint.h"
#include "tests/support/rendering/wear.h"

namespace mapweld::rendered {
namespace {

// Calls draw(x, y) for every place at which something at (x, y) is to be drawn: beyond all edges too, if the picture
// tiles.
template <typename Draw>
void wherever(const cv::Mat& canvas, bool tiles, double x, double y, const Draw& draw) {
  const int around = tiles ? 1 : 0;
  for (int i = -around; i <= around; ++i) {
    for (int j = -around; j <= around; ++j) draw(x + i * canvas.cols, y + j * canvas.rows);
  }
}

// Each channel has a gain of its own; contrast fades.
void fade(cv::Mat& canvas, double amount, Random& random) {
  const double light = 1 + 0.04 * amount * random.gaussian();
  const double contrast = 1 - 0.2 * amount * random.uniform();
  std::array<double, 3> gain{};
  for (double& channel : gain) channel = light * (1 + 0.012 * amount * random.gaussian());
  canvas.forEach<cv::Vec3b>([&](cv::Vec3b& pixel, const int*) {
    for (int c = 0; c < 3; ++c) {
      const double value = (128 + (pixel[c] - 128) * contrast) * gain[static_cast<std::size_t>(c)];
      pixel[c] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  });
}

// Of a stain's radius: nothing of it is left there, and the noise of its edge does not reach so far.
constexpr double kBeyondEdge = -4.0 / 3;

// A soft spot with a ragged edge, darker or lighter than what is around.
void stain(cv::Mat& canvas, double x, double y, double radius, double levels, const NoiseField& edge) {
  const int top = std::max(0, static_cast<int>(y - radius));
  const int bottom = std::min(canvas.rows, static_cast<int>(y + radius) + 1);
  const int left = std::max(0, static_cast<int>(x - radius));
  const int right = std::min(canvas.cols, static_cast<int>(x + radius) + 1);
  for (int row = top; row < bottom; ++row) {
    for (int column = left; column < right; ++column) {
      const double dx = (column - x) / radius;
      const double dy = (row - y) / radius;
      if (dx <= kBeyondEdge || dy <= kBeyondEdge) continue;
      const double inside = 1 - dx * dx - dy * dy + 0.5 * edge.at(3 * (dx + 1), 3 * (dy + 1));
      if (inside <= 0) continue;
      const int delta = static_cast<int>(levels * std::min(1.0, 2.5 * inside) + 1024.5) - 1024;
      auto& pixel = canvas.at<cv::Vec3b>(row, column);
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::clamp(pixel[c] + delta, 0, 255));
    }
  }
}

void scratch(cv::Mat& canvas, bool tiles, double amount, Random& random) {
  const double x = random.uniform(0, canvas.cols);
  const double y = random.uniform(0, canvas.rows);
  const double length = random.uniform(0.02, 0.1) * std::max(canvas.cols, canvas.rows);
  const double angle = random.uniform(0, 360);
  const double shade = 1 + (random.chance(0.5) ? -0.3 : 0.25) * amount;
  const auto& under = canvas.at<cv::Vec3b>(static_cast<int>(y), static_cast<int>(x));
  const Colour colour =
      scaled({static_cast<double>(under[0]), static_cast<double>(under[1]), static_cast<double>(under[2]), 255}, shade);
  wherever(canvas, tiles, x, y, [&](double x0, double y0) {
    stroke(canvas, x0, y0, x0 + length * cos_deg(angle), y0 + length * sin_deg(angle), colour, 1);
  });
}

Colour grey(Random& random, double low, double high) {
  const double value = random.uniform(low, high);
  const double green = random.uniform(0.94, 1.0);
  return rgb(value, value * green, value * random.uniform(0.85, 1.0));
}

constexpr int kMarkPx = 96;

double somewhere(Random& random) { return random.uniform(0.2, 0.8) * kMarkPx; }

void scuffs(cv::Mat& mark, Random& random) {
  const double angle = random.uniform(-35, 35);
  for (int i = random.between(2, 6); i > 0; --i) {
    const double x = somewhere(random);
    const double y = somewhere(random);
    const double length = random.uniform(10, 45);
    const double turn = angle + random.uniform(-12, 12);
    const Colour colour = grey(random, 40, 110);
    stroke(mark, x, y, x + length * cos_deg(turn), y + length * sin_deg(turn), colour, random.between(1, 3));
  }
}

void nail_holes(cv::Mat& mark, Random& random) {
  for (int i = random.between(1, 5); i > 0; --i) {
    const double x = somewhere(random);
    const double y = somewhere(random);
    const double radius = random.uniform(2.5, 4.5);
    const Colour rim = grey(random, 190, 240);
    disc(mark, x, y, radius, rim);
    disc(mark, x, y, radius * 0.5, grey(random, 20, 70));
  }
}

// Discs beside each other.
void blob(cv::Mat& mark, double x, double y, double radius, const Colour& colour, Random& random) {
  for (int i = 0; i < 9; ++i) {
    const double dx = random.uniform(-1, 1) * radius;
    const double dy = random.uniform(-1, 1) * radius * 0.7;
    disc(mark, x + dx, y + dy, radius * random.uniform(0.3, 0.7), colour);
  }
}

// Come off, or mended.
void plaster(cv::Mat& mark, Random& random) {
  const double x = somewhere(random);
  const double y = somewhere(random);
  const double radius = random.uniform(4, 13);
  const bool is_off = random.chance(0.5);
  const Colour colour = is_off ? grey(random, 60, 130) : grey(random, 170, 245);
  blob(mark, x, y, radius, colour, random);
  if (is_off) blob(mark, x, y, radius * 0.6, scaled(colour, 1.5), random);
}

// What held the corners of a sheet.
void tape(cv::Mat& mark, Random& random) {
  const double width = random.uniform(25, 60);
  const double height = random.uniform(30, 70);
  const Colour colour = grey(random, 170, 250);
  for (int corner = 0; corner < 4; ++corner) {
    if (random.chance(0.25)) continue;
    const double x = 8 + (corner % 2 == 1 ? width : 0) + random.uniform(-3, 3);
    const double y = 8 + (corner / 2 == 1 ? height : 0) + random.uniform(-3, 3);
    const double length = random.uniform(5, 12);
    fill(mark, x, y, length, random.uniform(4, 7), colour);
  }
}

}  // namespace

void wear_down(cv::Mat& canvas, bool tiles, double amount, Random& random) {
  cv::Mat alpha;
  if (canvas.channels() == 4) {
    cv::extractChannel(canvas, alpha, 3);
    cv::Mat colours(canvas.size(), CV_8UC3);
    cv::mixChannels(canvas, colours, {0, 0, 1, 1, 2, 2});
    canvas = colours;
  }
  const double size = std::max(canvas.cols, canvas.rows);
  fade(canvas, amount, random);
  // Lacquer and metal, on small canvases, are smoother.
  const double grain = size < 80 ? 3 * amount : 7 * amount;
  add_noise(canvas, std::max(4.0, size / 20), grain, random.next());
  add_noise(canvas, 3, 0.8 * grain, random.next());
  for (int i = random.between(2, 5); i > 0; --i) {
    const double x = random.uniform(0, canvas.cols);
    const double y = random.uniform(0, canvas.rows);
    const double radius = random.uniform(0.02, 0.09) * size + 2;
    const double levels = random.uniform(8, 26) * (random.chance(0.75) ? -amount : amount);
    const NoiseField edge(7, 7, random.next());
    wherever(canvas, tiles, x, y, [&](double x0, double y0) { stain(canvas, x0, y0, radius, levels, edge); });
  }
  for (int i = random.between(3, 8); i > 0; --i) scratch(canvas, tiles, amount, random);
  if (alpha.empty()) return;
  cv::Mat both;
  cv::merge(std::vector<cv::Mat>{canvas, alpha}, both);
  canvas = both;
}

cv::Mat seen_from_another_storey(const cv::Mat& view, double amount, Random& random) {
  const auto cut = [&](int size, double most, int& from) {
    const int away = static_cast<int>(size * most * amount * random.uniform());
    from = random.below(away + 1);
    return size - away;
  };
  cv::Rect part;
  part.height = cut(view.rows, 0.3, part.y);
  part.width = cut(view.cols, 0.15, part.x);
  return view(part).clone();
}

cv::Mat paint_mark(Random& random) {
  cv::Mat mark = clear_canvas(kMarkPx, kMarkPx, rgb(120, 116, 108));
  switch (random.below(5)) {
    case 0:
      scuffs(mark, random);
      break;
    case 1:
      nail_holes(mark, random);
      break;
    case 2:
    case 3:
      plaster(mark, random);
      break;
    default:
      tape(mark, random);
  }
  return mark;
}

}  // namespace mapweld::rendered
