#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "tests/support/rendering/catalogue.h"

namespace mapweld::rendered {
namespace {

cv::Mat paint_vending(Random& random) {
  const int w = 256;
  const int h = 520;
  const Colour colour = Hsv{random.uniform(0, 360), random.uniform(0.6, 0.95), random.uniform(0.4, 0.8)};
  cv::Mat c = canvas(w, h, colour);
  text(c, made_up_word(random), 20, 44, 28, rgb(250, 250, 246), 4);
  fill(c, 14, 60, w * 0.66, h * 0.68, rgb(40, 42, 48));
  for (int r = 0; r < 6; ++r) {
    for (int k = 0; k < 5; ++k) {
      const Colour product = any_colour(random);
      const double x = 20 + k * 33;
      const double y = 68 + r * 58;
      fill(c, x, y, 25, 40, product);
      fill(c, x + 4, y + 8, 17, 10, scaled(product, 1.8));
      fill(c, x + 6, y + 24, 13, 8, any_colour(random));
    }
    fill(c, 14, 68 + r * 58 + 42, w * 0.66, 6, rgb(190, 190, 190));
  }
  fill(c, w * 0.78, 90, 44, 60, rgb(30, 60, 70));
  for (int i = 0; i < 12; ++i) fill(c, w * 0.78 + (i % 3) * 15, 170 + (i / 3) * 16, 11, 11, rgb(215, 215, 215));
  fill(c, w * 0.2, h * 0.86, w * 0.45, h * 0.09, rgb(24, 24, 26));
  outline(c, 0, 0, w, h, scaled(colour, 0.6), 5);
  return c;
}

cv::Mat paint_fridge(Random& random) {
  cv::Mat c = canvas(180, 520, rgb(226, 228, 228));
  add_noise(c, 60, 4, random.next());
  fill(c, 0, 180, 180, 4, rgb(90, 92, 94));
  fill(c, 12, 90, 8, 76, rgb(110, 112, 116));
  fill(c, 12, 200, 8, 110, rgb(110, 112, 116));
  for (int i = 0; i < 9; ++i) {
    const double x = random.uniform(35, 130);
    const double y = random.uniform(20, 420);
    const double s = random.uniform(14, 46);
    const Colour colour = any_colour(random);
    fill(c, x, y, s, s * 1.2, colour);
    if (s > 28) print_lines(c, x + 4, y + 5, s - 8, s, 7, scaled(colour, 0.4), random);
  }
  outline(c, 0, 0, 180, 520, rgb(160, 162, 164), 3);
  return c;
}

cv::Mat paint_copier(Random& random) {
  cv::Mat c = canvas(190, 290, rgb(206, 208, 206));
  fill(c, 0, 0, 190, 46, rgb(70, 74, 80));
  fill(c, 110, 10, 60, 26, rgb(80, 130, 160));
  for (int i = 0; i < 6; ++i) fill(c, 14 + i * 14, 16, 9, 9, i == 5 ? rgb(40, 170, 80) : rgb(190, 190, 190));
  fill(c, 16, 62, 130, 26, rgb(40, 40, 44));
  fill(c, 24, 76, 100, 8, rgb(245, 245, 240));
  for (int i = 0; i < 3; ++i) {
    outline(c, 8, 108 + i * 58, 174, 52, rgb(130, 132, 134), 3);
    fill(c, 70, 124 + i * 58, 50, 9, rgb(80, 82, 86));
    fill(c, 150, 120 + i * 58, 22, 16, any_colour(random));
  }
  return c;
}

cv::Mat paint_rack(Random& random) {
  const int w = 180;
  const int h = 540;
  cv::Mat c = canvas(w, h, rgb(44, 46, 52));
  double y = 10;
  while (y < h - 30) {
    const double unit = random.between(1, 4) * 18.0;
    const Colour colour = Hsv{random.uniform(180, 260), random.uniform(0.02, 0.3), random.uniform(0.15, 0.75)};
    fill(c, 10, y, w - 20, unit - 3, colour);
    switch (random.below(4)) {
      case 0:
        for (int i = 0; i < 12; ++i) {
          fill(c, 20 + i * 11, y + 4, 6, 6, Hsv{random.uniform(0, 360), 0.9, random.uniform(0.4, 1.0)});
        }
        break;
      case 1:
        fill(c, 26, y + 4, 60, unit - 11, rgb(60, 150, 120));
        break;
      case 2:
        for (int i = 0; i < 5; ++i) disc(c, 30 + i * 28, y + unit / 2, std::min(7.0, unit / 3), rgb(225, 225, 220));
        break;
      default:
        for (double x = 20; x < w - 24; x += 6) fill(c, x, y + 4, 3, unit - 11, scaled(colour, 0.5));
    }
    y += unit;
  }
  for (int i = 0; i < 6; ++i) {
    const Colour cable = Hsv{random.uniform(0, 360), 0.8, 0.8};
    const double x = random.uniform(14, w - 14);
    const double y0 = random.uniform(20, 300);
    const double x1 = x + random.uniform(-30, 30);
    stroke(c, x, y0, x1, y0 + random.uniform(40, 180), cable, 3);
  }
  outline(c, 0, 0, w, h, rgb(24, 24, 26), 7);
  return c;
}

cv::Mat paint_screen(Random& random) {
  const int w = 208;
  const int h = 128;
  const bool dark = random.chance(0.5);
  cv::Mat c = canvas(w, h, dark ? rgb(30, 34, 42) : rgb(225, 232, 238));
  const Colour ink = dark ? rgb(170, 210, 180) : rgb(50, 56, 66);
  switch (random.below(3)) {
    case 0:
      print_lines(c, 12, 14, w * 0.7, h - 26, 9, ink, random);
      break;
    case 1: {
      fill(c, 10, 12, w * 0.42, h * 0.5, any_colour(random));
      print_lines(c, w * 0.55, 14, w * 0.38, h - 30, 9, ink, random);
      double last = h * 0.8;
      for (int i = 0; i < 7; ++i) {
        const double next = h * random.uniform(0.65, 0.92);
        stroke(c, 10 + i * 13, last, 23 + i * 13, next, any_colour(random), 2);
        last = next;
      }
      break;
    }
    default:
      random_gradient(c, random);
      for (int i = 0; i < 8; ++i) {
        const double x = 14 + (i / 4) * 30;
        fill(c, x, 14 + (i % 4) * 24, 14, 14, any_colour(random));
      }
  }
  outline(c, 0, 0, w, h, rgb(20, 20, 22), 6);
  return c;
}

cv::Mat paint_keyboard() {
  cv::Mat c = canvas(128, 48, rgb(50, 50, 54));
  for (int i = 0; i < 60; ++i) fill(c, 6 + (i % 15) * 8, 6 + (i / 15) * 10, 6, 7, rgb(190, 190, 186));
  return c;
}

}  // namespace

cv::Mat paint_machine(Design design, Random& random) {
  switch (design) {
    case Design::kVending:
      return paint_vending(random);
    case Design::kFridge:
      return paint_fridge(random);
    case Design::kCopier:
      return paint_copier(random);
    case Design::kRack:
      return paint_rack(random);
    case Design::kKeyboard:
      return paint_keyboard();
    default:
      return paint_screen(random);
  }
}

}  // namespace mapweld::rendered
