#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tests/support/rendering/catalogue.h"

namespace mapweld::rendered {
namespace {

Colour wood(Random& random) {
  return Hsv{random.uniform(18, 38), random.uniform(0.25, 0.6), random.uniform(0.35, 0.85)};
}

cv::Mat paint_bookshelf(Random& random) {
  const int w = 240;
  const int h = 520;
  const Colour frame = random.chance(0.7) ? wood(random) : rgb(220, 220, 214);
  cv::Mat c = canvas(w, h, scaled(frame, 0.35));
  const int shelves = random.between(4, 6);
  const double pitch = static_cast<double>(h) / shelves;
  for (int s = 0; s < shelves; ++s) {
    const double base = (s + 1) * pitch - 8;
    double x = 10;
    while (x < w - 16) {
      if (random.chance(0.1)) {
        x += random.uniform(14, 46);
        continue;
      }
      if (random.chance(0.07)) {  // a box or a pot
        const double bw = random.uniform(24, 50);
        if (x + bw > w - 10) break;
        const double bh = pitch * random.uniform(0.3, 0.6);
        const Colour colour = any_colour(random);
        fill(c, x, base - bh, bw, bh, colour);
        fill(c, x + 5, base - bh * 0.7, bw - 10, bh * 0.3, scaled(colour, 1.6));
        x += bw + 3;
        continue;
      }
      const bool folder = random.chance(0.25);
      const double bw = folder ? random.uniform(15, 20) : random.uniform(6, 15);
      if (x + bw > w - 10) break;
      const double bh = (pitch - 14) * (folder ? 0.86 : random.uniform(0.55, 0.92));
      const Colour colour = folder ? Hsv{random.uniform(0, 360), random.uniform(0.0, 0.7), random.uniform(0.15, 0.8)}
                                   : any_colour(random);
      fill(c, x, base - bh, bw, bh, colour);
      fill(c, x, base - bh, 1.5, bh, scaled(colour, 0.6));
      if (folder) {
        fill(c, x + 2, base - bh * 0.8, bw - 4, bh * 0.3, rgb(240, 240, 234));
        disc(c, x + bw / 2, base - bh * 0.2, 3, rgb(30, 30, 30));
      } else if (random.chance(0.6)) {
        const double band = bh * random.uniform(0.5, 0.9);
        fill(c, x + 1, base - band, bw - 2, bh * 0.12, scaled(colour, random.chance(0.5) ? 1.7 : 0.5));
      }
      x += bw;
    }
    fill(c, 0, base, w, 8, frame);
    fill(c, 0, base + 6, w, 3, scaled(frame, 0.6));
  }
  fill(c, 0, 0, 9, h, frame);
  fill(c, w - 9, 0, 9, h, frame);
  fill(c, 0, 0, w, 9, frame);
  return c;
}

cv::Mat paint_store_shelf(Random& random) {
  const int w = 280;
  const int h = 500;
  cv::Mat c = canvas(w, h, rgb(66, 66, 70));
  const int shelves = 4;
  const double pitch = static_cast<double>(h) / shelves;
  for (int s = 0; s < shelves; ++s) {
    const double base = (s + 1) * pitch - 10;
    double x = 8;
    while (x < w - 40) {
      const double bw = random.uniform(34, 90);
      if (x + bw > w - 8) break;
      const double bh = pitch * random.uniform(0.35, 0.8);
      const Colour colour =
          random.chance(0.5) ? Hsv{random.uniform(24, 36), 0.4, random.uniform(0.5, 0.75)} : any_colour(random);
      fill(c, x, base - bh, bw, bh, colour);
      outline(c, x, base - bh, bw, bh, scaled(colour, 0.6), 2);
      if (random.chance(0.7)) {
        fill(c, x + bw * 0.2, base - bh * 0.7, bw * 0.6, bh * 0.35, rgb(240, 238, 230));
        print_lines(c, x + bw * 0.24, base - bh * 0.66, bw * 0.5, bh * 0.3, 8, rgb(50, 50, 50), random);
      } else {
        fill(c, x, base - bh * 0.55, bw, 7, rgb(210, 190, 140));
      }
      x += bw + random.uniform(2, 16);
    }
    fill(c, 0, base, w, 10, rgb(150, 154, 160));
  }
  fill(c, 0, 0, 8, h, rgb(140, 144, 150));
  fill(c, w - 8, 0, 8, h, rgb(140, 144, 150));
  return c;
}

cv::Mat paint_cabinet(Random& random) {
  const int w = 220;
  const int h = 350;
  const Colour colour = random.chance(0.4)
                            ? wood(random)
                            : Hsv{random.uniform(0, 360), random.uniform(0.02, 0.4), random.uniform(0.4, 0.85)};
  cv::Mat c = canvas(w, h, colour);
  add_noise(c, 30, 4, random.next());
  if (random.chance(0.5)) {
    for (const double x : {0.0, w / 2.0}) {
      outline(c, x + 3, 4, w / 2.0 - 6, h - 10, scaled(colour, 0.65), 3);
    }
    fill(c, w / 2.0 - 16, h * 0.42, 6, 44, rgb(200, 200, 200));
    fill(c, w / 2.0 + 10, h * 0.42, 6, 44, rgb(200, 200, 200));
    if (random.chance(0.5)) {
      const double x = random.uniform(15, 60);
      fill(c, x, 40, 50, 66, rgb(244, 244, 236));
      print_lines(c, x + 5, 48, 40, 50, 8, rgb(60, 60, 60), random);
    }
  } else {
    const int drawers = random.between(3, 4);
    for (int i = 0; i < drawers; ++i) {
      const double y = static_cast<double>(h) * i / drawers;
      outline(c, 4, y + 3, w - 8, static_cast<double>(h) / drawers - 6, scaled(colour, 0.65), 3);
      fill(c, w * 0.38, y + h * 0.06, w * 0.24, 8, rgb(190, 192, 196));
      fill(c, w * 0.4, y + h * 0.11, w * 0.2, 18, rgb(240, 240, 234));
      print_lines(c, w * 0.42, y + h * 0.12, w * 0.16, 12, 7, rgb(40, 40, 40), random);
    }
  }
  return c;
}

cv::Mat paint_drawers(Random& random) {
  const Colour colour = random.chance(0.5) ? wood(random) : rgb(205, 205, 200);
  cv::Mat c = canvas(128, 184, colour);
  for (int i = 0; i < 3; ++i) {
    outline(c, 4, 4 + i * 60, 120, 56, scaled(colour, 0.6), 3);
    fill(c, 46, 18 + i * 60, 36, 6, rgb(70, 70, 74));
  }
  return c;
}

cv::Mat paint_kitchen(Random& random) {
  const int w = 500;
  const int h = 250;
  const Colour colour = random.chance(0.5) ? wood(random) : any_colour(random);
  cv::Mat c = canvas(w, h, colour);
  for (int i = 0; i < 4; ++i) {
    outline(c, i * 125.0 + 4, 22, 117, h - 50, scaled(colour, 0.6), 3);
    fill(c, i * 125.0 + 50, 38, 30, 6, rgb(200, 200, 200));
  }
  fill(c, 254, 26, 117, h - 56, rgb(40, 40, 44));
  fill(c, 266, 70, 92, 90, rgb(80, 84, 92));
  for (int i = 0; i < 4; ++i) disc(c, 275 + i * 24, 46, 7, rgb(210, 210, 210));
  fill(c, 0, 0, w, 18, rgb(120, 118, 114));
  fill(c, 0, h - 20, w, 20, rgb(40, 38, 36));
  return c;
}

cv::Mat paint_radiator() {
  cv::Mat c = canvas(256, 128, rgb(228, 228, 222));
  for (int i = 0; i < 16; ++i) {
    fill(c, i * 16, 8, 5, 112, rgb(170, 170, 164));
    fill(c, i * 16 + 5, 8, 3, 112, rgb(246, 246, 240));
  }
  fill(c, 0, 0, 256, 7, rgb(205, 205, 200));
  fill(c, 0, 120, 256, 8, rgb(150, 150, 146));
  return c;
}

cv::Mat paint_leaves(Random& random) {
  const int w = 220;
  const int h = 270;
  const double hue = random.uniform(80, 140);
  const Colour green = Hsv{hue, random.uniform(0.45, 0.8), random.uniform(0.3, 0.55)};
  cv::Mat c = clear_canvas(w, h, scaled(green, 0.7));
  const int stems = random.between(9, 15);
  const bool broad = random.chance(0.5);
  for (int i = 0; i < stems; ++i) {
    const double top_x = w * random.uniform(0.06, 0.94);
    const double top_y = h * random.uniform(0.03, 0.6);
    stroke(c, w / 2.0, h, top_x, top_y, scaled(green, 0.6), 4);
    for (int k = 0; k < (broad ? 4 : 8); ++k) {
      const double t = random.uniform(0.35, 1.0);
      const double x = w / 2.0 + (top_x - w / 2.0) * t;
      const double y = h + (top_y - h) * t;
      const Colour leaf = scaled(green, random.uniform(0.6, 1.6));
      if (broad) {
        const double angle = random.uniform(0, 180);
        const cv::Size size{random.between(12, 22), random.between(5, 9)};
        cv::ellipse(c, cv::Point(static_cast<int>(x), static_cast<int>(y)), size, static_cast<int>(angle), 0, 360, leaf,
                    cv::FILLED);
        stroke(c, x - 8, y, x + 8, y, scaled(leaf, 0.7), 1);
      } else {
        const double dx = random.uniform(-22, 22);
        const double dy = random.uniform(-22, 8);
        stroke(c, x, y, x + dx, y + dy, leaf, 4);
      }
    }
  }
  return c;
}

cv::Mat paint_carton(Random& random) {
  const Colour colour = Hsv{random.uniform(26, 36), random.uniform(0.35, 0.5), random.uniform(0.5, 0.75)};
  cv::Mat c = canvas(150, 116, colour);
  add_noise(c, 20, 7, random.next());
  fill(c, 0, 52, 150, 12, rgb(206, 180, 130));
  text(c, made_up_word(random), 12, 36, 15, rgb(60, 40, 26), 2);
  fill(c, 90, 76, 46, 32, rgb(244, 242, 236));
  print_lines(c, 94, 80, 38, 26, 7, rgb(40, 40, 40), random);
  return c;
}

cv::Mat paint_rug(Random& random) {
  const Colour colour = any_colour(random);
  const Colour second = any_colour(random);
  cv::Mat c = canvas(256, 180, colour);
  for (int i = 0; i < 4; ++i)
    outline(c, 6 + i * 14, 6 + i * 14, 244 - i * 28, 168 - i * 28, i % 2 ? second : scaled(colour, 0.6), 4);
  for (int i = 0; i < 5; ++i) disc(c, 70 + i * 29, 90, 11, i % 2 ? second : scaled(second, 0.5));
  add_noise(c, 3, 10, random.next());
  return c;
}

}  // namespace

cv::Mat paint_furniture(Design design, Random& random) {
  switch (design) {
    case Design::kBookshelf:
      return paint_bookshelf(random);
    case Design::kStoreShelf:
      return paint_store_shelf(random);
    case Design::kCabinet:
      return paint_cabinet(random);
    case Design::kDrawers:
      return paint_drawers(random);
    case Design::kKitchen:
      return paint_kitchen(random);
    case Design::kRadiator:
      return paint_radiator();
    case Design::kPaper: {
      cv::Mat c = canvas(120, 84, rgb(246, 246, 242));
      fill(c, 8, 8, 40, 8, any_colour(random));
      print_lines(c, 8, 22, 104, 56, 8, rgb(70, 70, 76), random);
      return c;
    }
    case Design::kLeaves:
      return paint_leaves(random);
    case Design::kCarton:
      return paint_carton(random);
    case Design::kRug:
      return paint_rug(random);
    case Design::kLampPanel: {
      cv::Mat c = canvas(128, 32, rgb(252, 252, 246));
      for (int i = 1; i < 16; ++i) fill(c, i * 8, 0, 1, 32, rgb(226, 228, 226));
      outline(c, 0, 0, 128, 32, rgb(180, 182, 184), 2);
      return c;
    }
    default: {
      if (random.chance(0.6)) {  // a loudspeaker behind its holes
        cv::Mat speaker = canvas(96, 96, rgb(222, 222, 216));
        disc(speaker, 48, 48, 42, rgb(186, 186, 180));
        for (int i = 0; i < 49; ++i)
          disc(speaker, 18 + 10 * (i % 7), 18 + 10 * (i / 7.0 - i % 7 / 7.0), 2.6, rgb(70, 70, 70));
        return speaker;
      }
      cv::Mat c = canvas(96, 96, rgb(212, 212, 208));
      for (int i = 0; i < 7; ++i) fill(c, 8, 10 + i * 12, 80, 6, rgb(90, 92, 96));
      outline(c, 0, 0, 96, 96, rgb(170, 170, 168), 3);
      return c;
    }
  }
}

}  // namespace mapweld::rendered
