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
  const int style = random.below(6);
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
        const double shade = random.uniform(0.965, 1.015);
        fill(wall, x, y, width / 10.0, height / static_cast<double>(rows), scaled(colour, shade));
        if (r % 2 == 1 && c == 9)
          fill(wall, 0, y, width / 20.0, height / static_cast<double>(rows), scaled(colour, shade));
      }
      stroke(wall, 0, y, width, y, scaled(colour, 0.86), 1);
      for (int c = 0; c < 10; ++c) {
        const double x = width * (c + 0.5 * (r % 2)) / 10;
        fill(wall, x, y, 1, height / static_cast<double>(rows), scaled(colour, 0.88));
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
  }
  add_noise(wall, 90, 4, random.next());
  add_noise(wall, 5, 3, random.next());
  for (int i = 0; i < 10; ++i) {  // scuffs of trolleys and shoes
    const double x = random.uniform(0, width - 40);
    const double y = height * random.uniform(0.7, 0.95);
    const double dx = random.uniform(4, 36);
    const double dy = random.uniform(-3, 3);
    stroke(wall, x, y, x + dx, y + dy, scaled(colour, random.uniform(0.7, 0.9)), 1);
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
      fill(floor, (i % 4) * 80, (i / 4) * 80, 80, 80, scaled(colour, random.uniform(0.92, 1.08)));
    }
    add_noise(floor, 3, 14, random.next());
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
    add_noise(floor, 8, 6, random.next());
    return floor;
  }
  if (style == 2) {  // ceramic tiles
    const Colour colour = Hsv{random.uniform(0, 360), random.uniform(0.02, 0.15), random.uniform(0.6, 0.8)};
    cv::Mat floor = canvas(size, size, scaled(colour, 0.7));
    for (int i = 0; i < 16; ++i) {
      fill(floor, (i % 4) * 80 + 1, (i / 4) * 80 + 1, 78, 78, scaled(colour, random.uniform(0.93, 1.04)));
    }
    add_noise(floor, 20, 7, random.next());
    add_noise(floor, 3, 5, random.next());
    return floor;
  }
  // linoleum
  const Colour colour = Hsv{random.uniform(60, 220), random.uniform(0.05, 0.25), random.uniform(0.5, 0.7)};
  cv::Mat floor = canvas(size, size, colour);
  add_noise(floor, 40, 8, random.next());
  for (int i = 0; i < 900; ++i) {
    const double x = random.uniform(0, size);
    const double y = random.uniform(0, size);
    const double width = random.uniform(1, 4);
    const double height = random.uniform(1, 3);
    fill(floor, x, y, width, height, scaled(colour, random.uniform(0.8, 1.2)));
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
  for (int i = 0; i < 260; ++i) {
    const double x = random.uniform(0, size);
    const double y = random.uniform(0, size);
    fill(ceiling, x, y, 1, 1, scaled(colour, 0.8));
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
    const std::uint64_t seed = random.next();
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const double v = value_noise(x * 4.0 / size, y * 32.0 / size, 4, 32, seed);
        cv::Vec3b& pixel = wood.at<cv::Vec3b>(y, x);
        for (int c = 0; c < 3; ++c) {
          pixel[c] = static_cast<std::uint8_t>(std::clamp(static_cast<int>(pixel[c] + 14 * v), 0, 255));
        }
      }
    }
    return wood;
  }
  cv::Mat plain = canvas(size, size,
                         style == 1 ? Hsv{random.uniform(0, 360), random.uniform(0.0, 0.1), random.uniform(0.7, 0.9)}
                                    : Hsv{random.uniform(0, 360), random.uniform(0.1, 0.6), random.uniform(0.3, 0.7)});
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
      const double saturation = random.uniform(0.1, 0.8);
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
    default: {
      cv::Mat lacquer = canvas(32, 32, scaled(any_colour(random), 0.8));
      return lacquer;
    }
  }
}

}  // namespace mapweld::rendered
