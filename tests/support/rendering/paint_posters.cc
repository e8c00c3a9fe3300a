#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tests/support/rendering/catalogue.h"

namespace mapweld::rendered {
namespace {

Colour ink_on(const Colour& paper) {
  return paper[0] * 0.11 + paper[1] * 0.59 + paper[2] * 0.3 > 128 ? rgb(30, 28, 34) : rgb(240, 238, 228);
}

void title(cv::Mat& c, double x, double y, double width, double height, const Colour& colour, Random& random) {
  const std::string word = made_up_word(random);
  const double natural = 0.95 * height * static_cast<double>(word.size());
  const double fitted = std::min(height, height * width / natural);
  text(c, word, x, y + fitted, fitted, colour, std::max(1, static_cast<int>(fitted / 9)));
}

void chart(cv::Mat& c, double x, double y, double w, double h, Random& random) {
  fill(c, x, y, w, h, rgb(245, 245, 240));
  const Colour colour = any_colour(random);
  if (random.chance(0.5)) {
    const int bars = random.between(4, 8);
    for (int i = 0; i < bars; ++i) {
      const double height = h * random.uniform(0.15, 0.9);
      fill(c, x + w * (i + 0.15) / bars, y + h - height, w * 0.7 / bars, height, i % 2 ? colour : scaled(colour, 0.6));
    }
  } else {
    double last = y + h * random.uniform(0.3, 0.9);
    for (int i = 0; i < 8; ++i) {
      const double next = y + h * random.uniform(0.1, 0.9);
      stroke(c, x + w * i / 8, last, x + w * (i + 1) / 8, next, colour, 3);
      last = next;
    }
  }
  outline(c, x, y, w, h, rgb(60, 60, 60), 2);
}

void hills(cv::Mat& c, Random& random) {
  const double hue = random.uniform(0, 360);
  vertical_gradient(c, Hsv{hue, 0.5, random.uniform(0.5, 0.9)}, Hsv{hue + 40, 0.3, 0.95});
  const double sun_x = c.cols * random.uniform(0.2, 0.8);
  const double sun_y = c.rows * random.uniform(0.12, 0.35);
  const double sun = c.cols * random.uniform(0.06, 0.14);
  disc(c, sun_x, sun_y, sun, Hsv{random.uniform(20, 60), 0.5, 1.0});
  const int ranges = random.between(3, 5);
  for (int r = 0; r < ranges; ++r) {
    std::vector<cv::Point> line{{0, c.rows}};
    const double base = c.rows * (0.35 + 0.6 * r / ranges);
    const std::uint64_t seed = random.next();
    const NoiseField coarse(64, 64, seed);
    const NoiseField fine(64, 64, seed + 1);
    for (int x = 0; x <= c.cols; x += 6) {
      const double y = base + c.rows * (0.13 * coarse.at(x / 90.0, r) + 0.05 * fine.at(x / 22.0, r));
      line.emplace_back(x, static_cast<int>(y));
    }
    line.emplace_back(c.cols, c.rows);
    cv::fillPoly(c, std::vector<std::vector<cv::Point>>{line},
                 Hsv{hue + 60 + random.uniform(-40, 90), random.uniform(0.2, 0.7), 0.85 - 0.6 * r / ranges});
  }
  const int trees = random.between(14, 30);
  for (int i = 0; i < trees; ++i) {
    const double x = random.uniform(0, c.cols);
    const double y = c.rows * random.uniform(0.75, 0.98);
    const double size = c.rows * random.uniform(0.04, 0.12);
    const Colour green = Hsv{random.uniform(70, 150), 0.6, random.uniform(0.12, 0.4)};
    for (int k = 0; k < 4; ++k) {
      stroke(c, x - size * (0.1 + 0.1 * k), y - size * (1 - k * 0.25), x + size * (0.1 + 0.1 * k),
             y - size * (1 - k * 0.25), green, std::max(1, static_cast<int>(size * 0.22)));
    }
  }
}

void blocks(cv::Mat& c, Random& random) {
  const Colour line = random.chance(0.5) ? rgb(25, 25, 28) : rgb(238, 236, 230);
  struct Box {
    double x, y, w, h;
  };
  std::vector<Box> boxes{{0, 0, static_cast<double>(c.cols), static_cast<double>(c.rows)}};
  for (int i = 0; i < 19; ++i) {
    const auto which = static_cast<std::size_t>(random.below(static_cast<int>(boxes.size())));
    Box& box = boxes[which];
    const double cut = random.uniform(0.3, 0.7);
    Box other = box;
    if (box.w > box.h) {
      other.x = box.x + box.w * cut;
      other.w = box.w * (1 - cut);
      box.w *= cut;
    } else {
      other.y = box.y + box.h * cut;
      other.h = box.h * (1 - cut);
      box.h *= cut;
    }
    boxes.push_back(other);
  }
  for (const Box& box : boxes) {
    fill(c, box.x, box.y, box.w, box.h, any_colour(random));
    outline(c, box.x, box.y, box.w, box.h, line, 4);
  }
}

void shapes(cv::Mat& c, Random& random) {
  random_gradient(c, random);
  const int count = random.between(18, 34);
  for (int i = 0; i < count; ++i) {
    const Colour colour = any_colour(random);
    const double x = random.uniform(0, c.cols);
    const double y = random.uniform(0, c.rows);
    const double size = c.cols * random.uniform(0.04, 0.22);
    switch (random.below(4)) {
      case 0:
        disc(c, x, y, size, colour);
        break;
      case 1:
        disc(c, x, y, size, colour, 6);
        break;
      case 2:
        fill(c, x - size, y - size / 2, 2 * size, size, colour);
        break;
      default: {
        std::vector<cv::Point> triangle;
        for (int k = 0; k < 3; ++k) {
          const double px = x + size * random.uniform(-1.4, 1.4);
          const double py = y + size * random.uniform(-1.4, 1.4);
          triangle.emplace_back(static_cast<int>(px), static_cast<int>(py));
        }
        cv::fillPoly(c, std::vector<std::vector<cv::Point>>{triangle}, colour, cv::LINE_AA);
      }
    }
  }
}

void network(cv::Mat& c, Random& random) {
  const Colour paper = Hsv{random.uniform(0, 360), random.uniform(0.03, 0.3), random.chance(0.3) ? 0.2 : 0.92};
  fill(c, 0, 0, c.cols, c.rows, paper);
  std::vector<cv::Point2d> stations;
  for (int line = 0; line < 6; ++line) {
    const Colour colour = Hsv{line * 60 + random.uniform(0, 50), 0.8, 0.8};
    double x = c.cols * random.uniform(0.05, 0.95);
    double y = c.rows * random.uniform(0.05, 0.95);
    for (int k = 0; k < 7; ++k) {
      const int direction = random.below(8);
      const double length = c.cols * random.uniform(0.08, 0.25);
      const double nx = std::clamp(x + length * cos_deg(45.0 * direction), 8.0, c.cols - 8.0);
      const double ny = std::clamp(y + length * sin_deg(45.0 * direction), 8.0, c.rows - 8.0);
      stroke(c, x, y, nx, ny, colour, 6);
      x = nx;
      y = ny;
      stations.emplace_back(x, y);
    }
  }
  for (const cv::Point2d& station : stations) {
    disc(c, station.x, station.y, 6, rgb(30, 30, 30));
    disc(c, station.x, station.y, 3.5, rgb(250, 250, 250));
  }
}

void cells(cv::Mat& c, Random& random) {  // like a micrograph
  const double hue = random.uniform(0, 360);
  fill(c, 0, 0, c.cols, c.rows, Hsv{hue, 0.5, 0.2});
  const int count = random.between(30, 70);
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(0, c.cols);
    const double y = random.uniform(0, c.rows);
    const double r = c.cols * random.uniform(0.015, 0.07);
    const Colour colour = Hsv{hue + random.uniform(-60, 60), random.uniform(0.2, 0.8), random.uniform(0.35, 0.95)};
    disc(c, x, y, r, colour);
    disc(c, x + r * 0.2, y - r * 0.1, r * 0.4, scaled(colour, 0.5));
  }
  add_noise(c, 14, 16, random.next());
}

void face(cv::Mat& c, Random& random) {
  random_gradient(c, random);
  const Colour pattern = any_colour(random);
  const double pitch = random.uniform(22, 46);
  for (double py = pitch / 2; py < c.rows; py += pitch) {
    for (double px = pitch / 2; px < c.cols; px += pitch) {
      const double radius = pitch * random.uniform(0.08, 0.34);
      disc(c, px, py, radius, scaled(pattern, random.uniform(0.5, 1.4)));
    }
  }
  const double x = c.cols * random.uniform(0.42, 0.58);
  const double y = c.rows * 0.42;
  const double r = c.cols * random.uniform(0.2, 0.27);
  const Colour skin = Hsv{random.uniform(12, 32), random.uniform(0.25, 0.6), random.uniform(0.45, 0.95)};
  const Colour cloth = any_colour(random);
  disc(c, x, y + r * 2.9, r * 1.8, cloth);
  fill(c, x - r * 0.35, y + r * 0.6, r * 0.7, r, scaled(skin, 0.8));
  disc(c, x, y - r * 0.25, r * 1.12, Hsv{random.uniform(10, 50), 0.5, random.uniform(0.08, 0.6)});
  disc(c, x, y, r, skin);
  const double eye = r * random.uniform(0.3, 0.45);
  for (const double side : {-1.0, 1.0}) {
    disc(c, x + side * eye, y - r * 0.1, r * 0.13, rgb(245, 245, 245));
    disc(c, x + side * eye, y - r * 0.1, r * 0.07, rgb(30, 30, 40));
    stroke(c, x + side * (eye - r * 0.18), y - r * 0.32, x + side * (eye + r * 0.18), y - r * 0.36, rgb(50, 35, 30), 4);
  }
  stroke(c, x, y, x - r * 0.08, y + r * 0.3, scaled(skin, 0.7), 3);
  stroke(c, x - r * 0.3, y + r * 0.52, x + r * 0.3, y + r * random.uniform(0.45, 0.6), rgb(150, 50, 50), 4);
  for (int i = 0; i < 5; ++i) {
    stroke(c, x - r * 1.5, y + r * (2 + 0.35 * i), x + r * 1.5, y + r * (1.9 + 0.35 * i), scaled(cloth, 0.6), 3);
  }
}

void research(cv::Mat& c, Random& random) {
  const Colour accent = Hsv{random.uniform(0, 360), random.uniform(0.5, 0.95), random.uniform(0.25, 0.7)};
  fill(c, 0, 0, c.cols, c.rows, Hsv{random.uniform(0, 360), 0.04, 0.95});
  const double header = c.rows * random.uniform(0.1, 0.18);
  fill(c, 0, 0, c.cols, header, accent);
  title(c, c.cols * 0.06, header * 0.2, c.cols * 0.85, header * 0.4, rgb(250, 250, 245), random);
  print_lines(c, c.cols * 0.06, header * 0.72, c.cols * 0.7, header * 0.2, header * 0.14, rgb(225, 225, 225), random);
  const int columns = random.between(2, 3);
  const double w = c.cols * 0.92 / columns;
  for (int k = 0; k < columns; ++k) {
    const double x = c.cols * 0.05 + k * w;
    double y = header + c.rows * 0.03;
    while (y < c.rows * 0.9) {
      const double h = std::min(c.rows * random.uniform(0.1, 0.24), c.rows * 0.97 - y);
      switch (random.below(4)) {
        case 0:
          chart(c, x, y, w * 0.9, h, random);
          break;
        case 1: {
          fill(c, x, y, w * 0.9, h, any_colour(random));
          disc(c, x + w * 0.45, y + h / 2, std::min(w, h) * 0.3, any_colour(random));
          disc(c, x + w * 0.3, y + h * 0.4, std::min(w, h) * 0.16, any_colour(random));
          break;
        }
        default:
          fill(c, x, y, w * 0.55, 9, accent);
          print_lines(c, x, y + 15, w * 0.9, h - 15, 9, rgb(70, 70, 74), random);
      }
      y += h + c.rows * 0.025;
    }
  }
}

void lettering(cv::Mat& c, Random& random) {
  const Colour paper = any_colour(random);
  fill(c, 0, 0, c.cols, c.rows, paper);
  const Colour ink = ink_on(paper);
  const Colour second = any_colour(random);
  double y = c.rows * 0.06;
  while (y < c.rows * 0.85) {
    const double h = c.rows * random.uniform(0.06, 0.15);
    if (random.chance(0.3)) fill(c, 0, y - 4, c.cols, h + 12, second);
    title(c, c.cols * 0.07, y, c.cols * 0.88, h, random.chance(0.7) ? ink : any_colour(random), random);
    y += h + c.rows * 0.035;
  }
  print_lines(c, c.cols * 0.08, c.rows * 0.88, c.cols * 0.8, c.rows * 0.09, 11, ink, random);
}

void calendar(cv::Mat& c, Random& random) {
  fill(c, 0, 0, c.cols, c.rows, rgb(246, 244, 238));
  cv::Mat upper = c.rowRange(0, c.rows * 45 / 100);
  hills(upper, random);
  const double y0 = c.rows * 0.5;
  title(c, c.cols * 0.08, y0 - 8, c.cols * 0.6, c.rows * 0.05, rgb(180, 40, 40), random);
  for (int i = 0; i < 35; ++i) {
    const double x = c.cols * (0.06 + 0.126 * (i % 7));
    const double y = y0 + c.rows * 0.13 + c.rows * 0.072 * (i / 7);
    text(c, std::to_string(1 + i % 31), x, y, 12, i % 7 > 4 ? rgb(190, 40, 40) : rgb(40, 40, 40));
  }
}

}  // namespace

cv::Mat paint_poster(Random& random) {
  cv::Mat c = canvas(300, 424, rgb(255, 255, 255));
  switch (random.below(9)) {
    case 0:
      hills(c, random);
      break;
    case 1:
      blocks(c, random);
      break;
    case 2:
      shapes(c, random);
      break;
    case 3:
      network(c, random);
      break;
    case 4:
      cells(c, random);
      break;
    case 5:
      face(c, random);
      break;
    case 6:
      lettering(c, random);
      break;
    case 7:
      calendar(c, random);
      break;
    default:
      research(c, random);
      break;
  }
  if (random.chance(0.5)) {
    const Colour band = any_colour(random);
    const double y = random.chance(0.5) ? 0 : c.rows * 0.86;
    fill(c, 0, y, c.cols, c.rows * 0.14, band);
    title(c, c.cols * 0.08, y + c.rows * 0.03, c.cols * 0.84, c.rows * 0.075, ink_on(band), random);
  }
  add_noise(c, 40, 8, random.next());
  if (random.chance(0.5))
    outline(c, 0, 0, c.cols, c.rows, random.chance(0.5) ? rgb(30, 28, 26) : rgb(235, 232, 225), 10);
  return c;
}

cv::Mat paint_picture(Random& random) {
  cv::Mat c = canvas(420, 280, rgb(240, 238, 232));
  switch (random.below(5)) {
    case 0:
      hills(c, random);
      break;
    case 1:
      blocks(c, random);
      break;
    case 2:
      shapes(c, random);
      break;
    case 3:
      network(c, random);
      break;
    default:
      cells(c, random);
      break;
  }
  add_noise(c, 50, 8, random.next());
  outline(c, 0, 0, c.cols, c.rows, scaled(Hsv{random.uniform(10, 50), 0.5, random.uniform(0.15, 0.7)}, 1), 14);
  return c;
}

}  // namespace mapweld::rendered
