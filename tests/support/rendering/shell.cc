#include "tests/support/rendering/shell.h"

#include <algorithm>

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {

bool Wall::is_free(const Span& s, const Span& z) const {
  if (s.from < 0.05 || s.to > length_m - 0.05) return false;
  return std::none_of(taken.begin(), taken.end(), [&](const Taken& other) {
    return s.from < other.s.to && other.s.from < s.to && z.from < other.z.to && other.z.from < z.to;
  });
}

Wall wall_of(const Area& area, Side side) {
  switch (side) {
    case Side::kNorth:
      return {WallFrame::facing({area.x0, area.y1, 0}, {0, -1, 0}), area.width(), {}, {}};
    case Side::kSouth:
      return {WallFrame::facing({area.x1, area.y0, 0}, {0, 1, 0}), area.width(), {}, {}};
    case Side::kEast:
      return {WallFrame::facing({area.x1, area.y1, 0}, {-1, 0, 0}), area.height(), {}, {}};
    case Side::kWest:
      return {WallFrame::facing({area.x0, area.y0, 0}, {1, 0, 0}), area.height(), {}, {}};
  }
  return {};
}

double along_wall(const Area& area, Side side, double coordinate) {
  switch (side) {
    case Side::kNorth:
      return coordinate - area.x0;
    case Side::kSouth:
      return area.x1 - coordinate;
    case Side::kEast:
      return area.y1 - coordinate;
    case Side::kWest:
      return coordinate - area.y0;
  }
  return 0;
}

void build_floor_and_ceiling(Builder& b, const ShellDesigns& designs) {
  const Area& area = b.cell().area;
  const WallFrame frame = WallFrame::facing({area.x1, area.y0, 0}, {0, 1, 0});
  const Span s{0, area.width()};
  const Span t{0, area.height()};
  Skin floor = b.tiled(Design::kFloor, designs.floor, 2.0);
  floor.tile_down_m = 2.0;
  Skin ceiling = b.tiled(Design::kCeiling, designs.ceiling, 2.4);
  ceiling.tile_down_m = 2.4;
  floor.u_offset = designs.offset;
  floor.v_offset = designs.offset * 7;
  ceiling.u_offset = designs.offset * 3;
  ceiling.v_offset = designs.offset * 5;
  b.sheet(frame, s, t, 0, floor);
  b.sheet(frame, s, t, b.cell().height_m, ceiling, false);
}

void build_wall(Builder& b, const Wall& wall, const ShellDesigns& designs) {
  const double height = b.cell().height_m;
  Skin skin = b.tiled(Design::kWall, designs.wall, 4.0);
  skin.tile_down_m = height;
  const Skin jamb = b.tiled(Design::kPaint, designs.paint, 0.5);
  const auto piece = [&](const Span& s, double top, double bottom) {
    skin.u_offset = s.from / 4.0 + designs.offset;
    b.panel(wall.frame, s, 0, {bottom, top}, skin);
  };
  std::vector<Opening> openings = wall.openings;
  std::sort(openings.begin(), openings.end(), [](const Opening& a, const Opening& c) { return a.s.from < c.s.from; });
  double s = 0;
  for (const Opening& opening : openings) {
    piece({s, opening.s.from}, height, 0);
    piece(opening.s, height, opening.height_m);
    s = opening.s.to;
    const double depth = opening.depth_m;
    if (depth > 0) {
      const WallFrame left = WallFrame::facing(wall.frame.at(opening.s.from, 0, 0), wall.frame.along);
      const WallFrame right = WallFrame::facing(wall.frame.at(opening.s.to, -depth, 0), wall.frame.along * -1);
      b.panel(left, {0, depth}, 0, {0, opening.height_m}, jamb);
      b.panel(right, {0, depth}, 0, {0, opening.height_m}, jamb);
      b.sheet(wall.frame, opening.s, {-depth, 0}, opening.height_m, jamb, false);
      b.sheet(wall.frame, opening.s, {-depth, 0}, 0, b.tiled(Design::kMetal, 0), true);
    }
    b.cell().portals.push_back({opening.to_cell, wall.frame.at(opening.s.from, -depth, 0),
                                wall.frame.at(opening.s.to, -depth, opening.height_m), wall.frame.out});
  }
  piece({s, wall.length_m}, height, 0);
}

void build_lamps(Builder& b, double pitch_m, int rows) {
  const Area& area = b.cell().area;
  const double height = b.cell().height_m;
  const bool east_west = area.width() >= area.height();
  const WallFrame frame = east_west ? WallFrame::facing({area.x1, area.y0, 0}, {0, 1, 0})
                                    : WallFrame::facing({area.x0, area.y0, 0}, {1, 0, 0});
  const double length = std::max(area.width(), area.height());
  const double depth = std::min(area.width(), area.height());
  Skin panel = b.fitted(Design::kLampPanel, 0, Glow::kLamp);
  const Skin vent = b.fitted(Design::kVent, 0);
  const int count = std::max(1, static_cast<int>(length / pitch_m + 0.5));
  for (int i = 0; i < count; ++i) {
    const double s = length * (i + 0.5) / count;
    for (int row = 0; row < rows; ++row) {
      const double t = depth * (row + 0.5) / rows;
      const double power = b.wear().lamp_power();
      panel.glow = power > 0 ? Glow::kLamp : Glow::kNone;
      b.sheet(frame, {s - 0.6, s + 0.6}, {t - 0.15, t + 0.15}, height - 0.015, panel, false);
      b.cell().lamps.push_back(
          {frame.at(s, t, height - 0.02), 1.5 / (rows > 1 ? 1.4 : 1.0) * power, false, {0, 0, -1}});
    }
    if (i % 3 == 1)
      b.sheet(frame, {s + 1.0, s + 1.5}, {depth / 2 - 0.25, depth / 2 + 0.25}, height - 0.01, vent, false);
  }
}

void build_ceiling_things(Builder& b, std::uint64_t seed) {
  const Area& area = b.cell().area;
  const double height = b.cell().height_m;
  const WallFrame frame = WallFrame::facing({area.x1, area.y0, 0}, {0, 1, 0});
  Random random(seed);
  const int count = static_cast<int>(area.width() * area.height() / 2.0);
  for (int i = 0; i < count; ++i) {
    const double s = random.uniform(0.3, area.width() - 0.8);
    const double t = random.uniform(0.3, area.height() - 0.8);
    const double drop = random.uniform(0.03, 0.08);
    switch (random.below(4)) {
      case 0:  // a smoke detector
        b.box(frame, {s, s + 0.12}, {t, t + 0.12}, {height - drop, height}, all_over(b.tiled(Design::kMetal, 1)), true);
        b.sheet(frame, {s + 0.04, s + 0.08}, {t + 0.04, t + 0.08}, height - drop - 0.004, b.tiled(Design::kPaint, 4),
                false);
        break;
      case 1:  // a sprinkler
        b.box(frame, {s, s + 0.04}, {t, t + 0.04}, {height - drop, height}, all_over(b.tiled(Design::kMetal, 0)), true);
        b.sheet(frame, {s - 0.04, s + 0.08}, {t - 0.04, t + 0.08}, height - 0.01, b.tiled(Design::kMetal, 2), false);
        break;
      case 2:
        b.sheet(frame, {s, s + 0.45}, {t, t + 0.25}, height - 0.012, b.fitted(Design::kGrille, 0), false);
        break;
      default: {  // a loudspeaker, or a hatch
        const double size = random.uniform(0.2, 0.4);
        b.sheet(frame, {s, s + size}, {t, t + size}, height - 0.014,
                b.fitted(Design::kVent, static_cast<std::uint64_t>(random.below(6))), false);
      }
    }
  }
}

void build_door(Builder& b, const WallFrame& frame, double middle, double width, double height,
                const ShellDesigns& designs, bool leaf, std::uint64_t door) {
  const BoxSkin paint = all_over(b.tiled(Design::kPaint, designs.paint, 0.5));
  const double left = middle - width / 2;
  const double right = middle + width / 2;
  b.box(frame, {left - 0.09, left}, {0, 0.04}, {0, height + 0.09}, paint);
  b.box(frame, {right, right + 0.09}, {0, 0.04}, {0, height + 0.09}, paint);
  b.box(frame, {left, right}, {0, 0.04}, {height, height + 0.09}, paint, true);
  if (leaf) b.panel(frame, {left, right}, 0.012, {0.005, height}, b.fitted(Design::kDoor, door));
}

}  // namespace mapweld::rendered
