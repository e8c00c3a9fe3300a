#include <algorithm>
#include <array>

#include "tests/support/rendering/catalogue.h"

namespace mapweld::rendered {
namespace {

Colour wall_paint(Random& random) {
  const std::array<Colour, 9> colours{rgb(226, 218, 190), rgb(214, 220, 222), rgb(230, 228, 220),
                                      rgb(205, 214, 198), rgb(222, 206, 186), rgb(198, 208, 220),
                                      rgb(216, 200, 204), rgb(232, 222, 200), rgb(200, 200, 196)};
  return colours[static_cast<std::size_t>(random.below(static_cast<int>(colours.size())))];
}

cv::Mat paint_wall(Random& random) {
  const int width = 512;
  const int height = 360;
  const Colour colour = wall_paint(random);
  cv::Mat wall = canvas(width, height, colour);
  const int style = random.below(9);
  if (style == 1) {  // darker below a rail
    const double rail = height * random.uniform(0.58, 0.68);
    fill(wall, 0, rail, width, height - rail, scaled(colour, random.uniform(0.6, 0.85)));
    fill(wall, 0, rail - 5, width, 6, scaled(colour, 0.5));
  } else if (style == 2) {  // painted blocks
    const int rows = 14;
    for (int r = 0; r < rows; ++r) {
      const double y = static_cast<double>(height) * r / rows;
      for (int c = 0; c < 10; ++c) {
        const double x = width * (c + 0.5 * (r % 2)) / 10;
        const double shade = random.uniform(0.93, 1.04);
        fill(wall, x, y, width / 10.0, height / static_cast<double>(rows), scaled(colour, shade));
        if (r % 2 == 1 && c == 9)
          fill(wall, 0, y, width / 20.0, height / static_cast<double>(rows), scaled(colour, shade));
      }
      stroke(wall, 0, y, width, y, scaled(colour, 0.8), 1);
      for (int c = 0; c < 10; ++c) {
        const double x = width * (c + 0.5 * (r % 2)) / 10;
        fill(wall, x, y, 1, height / static_cast<double>(rows), scaled(colour, 0.82));
      }
    }
  } else if (style == 3) {  // panels
    for (int c = 0; c < 4; ++c) {
      const double x = width * c / 4.0;
      fill(wall, x, 0, width / 4.0, height, scaled(colour, random.uniform(0.95, 1.0)));
      fill(wall, x, 0, 2, height, scaled(colour, 0.75));
    }
  } else if (style == 4) {  // a coloured band
    fill(wall, 0, height * 0.5, width, height * 0.07, any_colour(random));
  } else if (style == 5) {  // roughcast
    add_noise(wall, 9, 16, random.next());
    add_noise(wall, 3, 12, random.next());
  } else if (style == 6) {  // bricks
    const Colour brick = Hsv{random.uniform(8, 40), random.uniform(0.2, 0.55), random.uniform(0.5, 0.85)};
    const double pitch_x = width / 18.0;
    const double pitch_y = height / 36.0;
    fill(wall, 0, 0, width, height, scaled(brick, 1.12));
    for (int r = 0; r < 36; ++r) {
      for (int c = -1; c < 18; ++c) {
        const double x = pitch_x * (c + 0.5 * (r % 2));
        const double shade = c < 17 || r % 2 == 0 ? random.uniform(0.88, 1.06) : 0.95;
        fill(wall, x, r * pitch_y, pitch_x - 2, pitch_y - 1.5, scaled(brick, c == -1 ? 0.95 : shade));
      }
    }
  } else if (style == 7) {  // wallpaper with a loose pattern
    const Colour leaf = scaled(colour, random.uniform(0.7, 0.88));
    for (int i = 0; i < 130; ++i) {
      const double x = random.uniform(8, width - 8);
      const double y = random.uniform(8, height - 20);
      const double size = random.uniform(3, 9);
      const double angle = random.uniform(0, 180);
      stroke(wall, x, y, x + size * cos_deg(angle), y + size * sin_deg(angle), leaf, 2);
      stroke(wall, x, y, x + size * cos_deg(angle + 70), y + size * sin_deg(angle + 70), leaf, 2);
      disc(wall, x, y, size * 0.25, scaled(colour, 0.75));
    }
  }
  add_noise(wall, 90, 4, random.next());
  add_noise(wall, 5, 3, random.next());
  for (int i = 0; i < 14; ++i) {  // scuffs of trolleys and shoes
    const double x = random.uniform(0, width - 40);
    const double y = height * random.uniform(0.7, 0.95);
    const double dx = random.uniform(3, 20);
    const double dy = random.uniform(-6, 6);
    stroke(wall, x, y, x + dx, y + dy, scaled(colour, random.uniform(0.55, 0.85)), 1);
  }
  for (int i = 0; i < 9; ++i) {  // screw holes, filled and not
    const double x = random.uniform(0, width);
    const double y = height * random.uniform(0.2, 0.6);
    const double radius = random.uniform(1.0, 2.2);
    disc(wall, x, y, radius, scaled(colour, random.chance(0.5) ? 0.45 : 1.12));
  }
  const Colour skirting = random.chance(0.5) ? rgb(70, 66, 62) : scaled(colour, 0.6);
  fill(wall, 0, height - 13, width, 13, skirting);
  fill(wall, 0, height - 14, width, 2, scaled(skirting, 1.3));
  return wall;
}

cv::Mat paint_floor(Random& random) {
  const int size = 320;
  const int style = random.below(4);
  if (style == 0) {  // carpet tiles
    const Colour colour = Hsv{random.uniform(180, 260), random.uniform(0.05, 0.3), random.uniform(0.28, 0.45)};
    cv::Mat floor = canvas(size, size, colour);
    for (int i = 0; i < 16; ++i) {
      fill(floor, (i % 4) * 80, (i / 4) * 80, 80, 80, scaled(colour, random.uniform(0.86, 1.12)));
    }
    add_noise(floor, 3, 30, random.next());
    add_noise(floor, 12, 14, random.next());
    return floor;
  }
  if (style == 1) {  // parquet
    const Colour colour = Hsv{random.uniform(22, 36), random.uniform(0.35, 0.6), random.uniform(0.5, 0.72)};
    cv::Mat floor = canvas(size, size, colour);
    for (int r = 0; r < 20; ++r) {
      double x = -random.uniform(0, 100);
      while (x < size) {
        const double length = random.uniform(70, 140);
        fill(floor, x, r * 16, length, 16, scaled(colour, random.uniform(0.86, 1.1)));
        fill(floor, x, r * 16, 1, 16, scaled(colour, 0.6));
        x += length;
      }
      fill(floor, 0, r * 16, size, 1, scaled(colour, 0.7));
    }
    add_noise(floor, 8, 10, random.next());
    return floor;
  }
  if (style == 2) {  // ceramic tiles
    const Colour colour = Hsv{random.uniform(0, 360), random.uniform(0.02, 0.15), random.uniform(0.6, 0.8)};
    cv::Mat floor = canvas(size, size, scaled(colour, 0.7));
    for (int i = 0; i < 16; ++i) {
      fill(floor, (i % 4) * 80 + 1, (i / 4) * 80 + 1, 78, 78, scaled(colour, random.uniform(0.9, 1.06)));
    }
    add_noise(floor, 20, 12, random.next());
    add_noise(floor, 4, 9, random.next());
    return floor;
  }
  // linoleum
  const Colour colour = Hsv{random.uniform(60, 220), random.uniform(0.05, 0.25), random.uniform(0.5, 0.7)};
  cv::Mat floor = canvas(size, size, colour);
  add_noise(floor, 40, 12, random.next());
  for (int i = 0; i < 1400; ++i) {
    const double x = random.uniform(0, size);
    const double y = random.uniform(0, size);
    const double width = random.uniform(1, 4);
    const double height = random.uniform(1, 3);
    fill(floor, x, y, width, height, scaled(colour, random.uniform(0.7, 1.3)));
  }
  return floor;
}

cv::Mat paint_ceiling(Random& random) {
  const int size = 256;
  const Colour colour = rgb(222, 222, 216);
  cv::Mat ceiling = canvas(size, size, colour);
  for (int i = 0; i < 16; ++i) {
    fill(ceiling, (i % 4) * 64, (i / 4) * 64, 64, 64, scaled(colour, random.uniform(0.96, 1.02)));
  }
  for (int i = 0; i < 420; ++i) {
    const double x = random.uniform(0, size);
    const double y = random.uniform(0, size);
    const double dot = random.uniform(1, 3);
    fill(ceiling, x, y, dot, dot, scaled(colour, random.uniform(0.66, 0.9)));
  }
  for (int i = 0; i < 4; ++i) {
    fill(ceiling, 0, i * 64, size, 2, scaled(colour, 0.82));
    fill(ceiling, i * 64, 0, 2, size, scaled(colour, 0.82));
  }
  return ceiling;
}

cv::Mat paint_laminate(Random& random) {
  const int size = 128;
  const int style = random.below(3);
  if (style == 0) {  // wood
    const Colour colour = Hsv{random.uniform(20, 40), random.uniform(0.3, 0.6), random.uniform(0.45, 0.8)};
    cv::Mat wood = canvas(size, size, colour);
    const NoiseField grain(4, 32, random.next());
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const double v = grain.at(x * 4.0 / size, y * 32.0 / size);
        cv::Vec3b& pixel = wood.at<cv::Vec3b>(y, x);
        for (int c = 0; c < 3; ++c) {
          pixel[c] = static_cast<std::uint8_t>(std::clamp(static_cast<int>(pixel[c] + 14 * v), 0, 255));
        }
      }
    }
    return wood;
  }
  cv::Mat plain =
      canvas(size, size,
             style == 1 ? Hsv{random.uniform(0, 360), random.uniform(0.0, 0.1), random.uniform(0.7, 0.9)}
                        : Hsv{random.uniform(0, 360), random.uniform(0.05, 0.35), random.uniform(0.35, 0.75)});
  add_noise(plain, 30, 4, random.next());
  return plain;
}

}  // namespace

cv::Mat paint_material(Design design, Random& random) {
  switch (design) {
    case Design::kWall:
      return paint_wall(random);
    case Design::kFloor:
      return paint_floor(random);
    case Design::kCeiling:
      return paint_ceiling(random);
    case Design::kLaminate:
      return paint_laminate(random);
    case Design::kFabric: {
      const double hue = random.uniform(0, 360);
      const double saturation = random.uniform(0.1, 0.55);
      cv::Mat fabric = canvas(128, 128, Hsv{hue, saturation, random.uniform(0.2, 0.7)});
      add_noise(fabric, 3, 12, random.next());
      return fabric;
    }
    case Design::kMetal: {
      cv::Mat metal = canvas(64, 64, Hsv{random.uniform(190, 230), 0.06, random.uniform(0.35, 0.75)});
      add_noise(metal, 16, 5, random.next());
      return metal;
    }
    case Design::kConcrete: {
      cv::Mat concrete = canvas(160, 160, rgb(150, 146, 138));
      add_noise(concrete, 30, 12, random.next());
      add_noise(concrete, 4, 14, random.next());
      return concrete;
    }
    case Design::kCables: {
      cv::Mat tray = canvas(200, 32, rgb(120, 124, 130));
      const int cables = random.between(5, 8);
      for (int i = 0; i < cables; ++i) {
        const double y = 3 + 26.0 * i / cables;
        const double saturation = random.chance(0.6) ? 0.05 : 0.7;
        stroke(tray, 0, y, 199, y, Hsv{random.uniform(0, 360), saturation, random.uniform(0.1, 0.9)}, 2);
      }
      for (int x = 10; x < 200; x += 40) fill(tray, x, 0, 5, 32, rgb(150, 154, 160));
      for (int i = 0; i < 3; ++i) {
        const double x = random.uniform(15, 170);
        const double y = random.uniform(2, 18);
        fill(tray, x, y, 18, 9, random.chance(0.5) ? rgb(240, 240, 235) : rgb(220, 190, 40));
      }
      return tray;
    }
    default: {  // mostly quiet colours, as joiners choose them
      const bool quiet = random.chance(0.85);
      const double hue = random.uniform(0, 360);
      const double saturation = quiet ? random.uniform(0.0, 0.16) : random.uniform(0.3, 0.6);
      return canvas(32, 32, Hsv{hue, saturation, random.uniform(0.2, 0.85)});
    }
  }
}

}  // namespace mapweld::rendered
