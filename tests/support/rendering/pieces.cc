#include "tests/support/rendering/pieces.h"

#include <array>

#include "tests/support/rendering/clutter.h"
#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
namespace {

BoxSkin fronted(Builder& b, Design front, std::uint64_t design) {
  const Skin sides = b.tiled(Design::kLaminate, design % 7);
  return {b.fitted(front, design), sides, sides, sides};
}

void hang(Builder& b, const WallFrame& f, Design picture, std::uint64_t design, const PieceSize& size, double thickness,
          double dz) {
  const Skin edge = b.tiled(Design::kPaint, design % 5);
  dz += b.wear().shift(0.03);
  const double s = b.wear().shift(0.03);
  const Span z{size.bottom_m + dz, size.top_m + dz};
  b.box(f, {s, s + size.width_m}, {0, thickness}, z, {b.fitted(picture, design), edge, edge, edge}, true);
}

void screen(Builder& b, const WallFrame& f, double s, double t, double z, double angle_deg, Random& random) {
  const WallFrame at = f.moved(s + b.wear().shift(0.12), t).turned(angle_deg + b.wear().shift(15));
  const Skin metal = b.tiled(Design::kMetal, 1);
  const std::uint64_t shown = b.wear().other(static_cast<std::uint64_t>(random.below(30)), 30, 0.8);
  const Skin picture = b.fitted(Design::kScreen, shown, Glow::kScreen);
  b.box(at, {-0.27, 0.27}, {-0.02, 0.03}, {z + 0.12, z + 0.46}, {picture, metal, metal, metal});
  b.box(at, {-0.03, 0.03}, {-0.03, 0.0}, {z, z + 0.14}, all_over(metal));
  b.box(at, {-0.12, 0.12}, {-0.1, 0.1}, {z, z + 0.02}, all_over(metal));
}

void desk(Builder& b, const WallFrame& f, const PieceSize& size, std::uint64_t design, Random& random) {
  const BoxSkin wood = all_over(b.tiled(Design::kLaminate, design % 7));
  const BoxSkin metal = all_over(b.tiled(Design::kMetal, design % 3));
  const double w = size.width_m;
  const double d = size.depth_m - 0.55;  // the chair stands in front
  b.box(f, {0, w}, {0, d}, {0.7, 0.74}, wood, true);
  b.box(f, {0.02, 0.06}, {0.05, d - 0.05}, {0, 0.7}, metal);
  b.box(f, {w - 0.06, w - 0.02}, {0.05, d - 0.05}, {0, 0.7}, metal);
  b.panel(f, {0.06, w - 0.06}, 0.08, {0.3, 0.7}, wood.front);
  const bool drawers_left = random.chance(0.5);
  const double s = drawers_left ? 0.1 : w - 0.52;
  b.box(f, {s, s + 0.42}, {0.1, d - 0.04}, {0.04, 0.64}, fronted(b, Design::kDrawers, design % 5));
  const double at = drawers_left ? w * 0.64 : w * 0.36;
  const double turn = random.uniform(-14, 14);
  screen(b, f, at, 0.25, 0.74, turn, random);
  const double keys = at + b.wear().shift(0.12);
  b.sheet(f, {keys - 0.23, keys + 0.22}, {d - 0.27, d - 0.11}, 0.752, b.fitted(Design::kKeyboard, design % 3));
  things_on_top(b, f, {0.05, w - 0.05}, {0.05, d - 0.05}, 0.742, random.between(3, 6), random);
  const double angle = random.uniform(-50, 50);
  chair(b, f, at, d + 0.2, angle, design);
}

void plant(Builder& b, const WallFrame& f, const PieceSize& size, std::uint64_t design, Random& random) {
  const BoxSkin pot = all_over(b.tiled(Design::kPaint, design % 9, 0.5));
  const double s = size.width_m / 2;
  const double t = size.depth_m / 2;
  b.box(f, {s - 0.16, s + 0.16}, {t - 0.16, t + 0.16}, {0, 0.34}, pot);
  const double top = random.uniform(1.1, 1.6) + b.wear().shift(0.25);
  const Skin leaves = b.fitted(Design::kLeaves, b.wear().other(design % 8, 8, 0.5));
  const double turn = random.uniform(0, 60) + b.wear().shift(30);
  for (const double angle : {0.0, 60.0, 120.0}) {
    b.cut_out(f, s, t, size.width_m * 1.3, {0.3, top}, turn + angle, leaves);
  }
}

void window(Builder& b, const WallFrame& f, const PieceSize& size, std::uint64_t design) {
  const BoxSkin frame = all_over(b.tiled(Design::kPaint, 3));
  const double w = size.width_m;
  const Span z{0.95, 2.25};
  b.panel(f, {0.05, w - 0.05}, 0.012, z, b.fitted(Design::kWindow, design, Glow::kDaylight));
  b.box(f, {0, 0.07}, {0, 0.07}, {z.from - 0.05, z.to + 0.05}, frame, true);
  b.box(f, {w - 0.07, w}, {0, 0.07}, {z.from - 0.05, z.to + 0.05}, frame, true);
  b.box(f, {w / 2 - 0.03, w / 2 + 0.03}, {0, 0.06}, z, frame);
  b.box(f, {0.07, w - 0.07}, {0, 0.07}, {z.to, z.to + 0.06}, frame, true);
  b.box(f, {-0.05, w + 0.05}, {0, 0.2}, {z.from - 0.06, z.from}, frame, true);
  b.box(f, {w / 2 - 0.55, w / 2 + 0.55}, {0.02, 0.12}, {0.15, 0.7},
        {b.fitted(Design::kRadiator, 0), frame.sides, frame.top, frame.back});
  b.cell().lamps.push_back({f.at(w / 2, 0.05, 1.6), 2.0, true, f.out});
}

void table(Builder& b, const WallFrame& f, const PieceSize& size, std::uint64_t design, Random& random) {
  const BoxSkin wood = all_over(b.tiled(Design::kLaminate, design % 7));
  const BoxSkin metal = all_over(b.tiled(Design::kMetal, design % 3));
  const double w = size.width_m;
  const double d = size.depth_m;
  b.box(f, {0.3, w - 0.3}, {0.4, d - 0.4}, {0.7, 0.74}, wood, true);
  for (const double s : {0.36, w - 0.42}) {
    for (const double t : {0.46, d - 0.52}) b.box(f, {s, s + 0.06}, {t, t + 0.06}, {0, 0.7}, metal);
  }
  things_on_top(b, f, {0.4, w - 0.4}, {0.45, d - 0.45}, 0.742, random.between(3, 7), random);
  for (double s = 0.7; s < w - 0.5; s += 0.75) {
    const double front = random.uniform(-20, 20);
    chair(b, f, s, d - 0.22, front, design);
    const double back = random.uniform(160, 200);
    chair(b, f, s, 0.22, back, design);
  }
}

void lab_bench(Builder& b, const WallFrame& f, const PieceSize& size, std::uint64_t design, Random& random) {
  const BoxSkin body = all_over(b.tiled(Design::kLaminate, design % 7));
  const double w = size.width_m;
  const double d = size.depth_m;
  b.box(f, {0, w}, {0, d}, {0.86, 0.9}, body, true);
  const BoxSkin front = fronted(b, Design::kDrawers, design % 5);
  for (double s = 0.05; s + 0.5 < w; s += 0.55) b.box(f, {s, s + 0.5}, {0.05, d - 0.05}, {0, 0.86}, front);
  for (double s = 0.3; s < w - 0.5; s += 0.7) {
    if (random.chance(0.5)) {
      const Skin rack = b.fitted(Design::kRack, static_cast<std::uint64_t>(random.below(8)));
      const Skin metal = b.tiled(Design::kMetal, 2);
      const double top = random.uniform(1.15, 1.5);
      b.box(f, {s, s + 0.42}, {0.12, 0.5}, {0.9, top}, {rack, metal, metal, rack});
    } else {
      screen(b, f, s + 0.2, 0.3, 0.9, 0, random);
    }
  }
  things_on_top(b, f, {0.05, w - 0.05}, {d - 0.35, d - 0.02}, 0.902, random.between(3, 6), random);
}

}  // namespace

PieceSize size_of(Piece piece) {
  switch (piece) {
    case Piece::kPoster:
      return {0.59, 0.02, 1.05, 1.89};
    case Piece::kPicture:
      return {0.9, 0.04, 1.25, 1.85};
    case Piece::kNoticeBoard:
      return {1.5, 0.03, 0.95, 1.95};
    case Piece::kWhiteboard:
      return {1.6, 0.03, 0.95, 1.95};
    case Piece::kSign:
      return {0.4, 0.02, 1.95, 2.15};
    case Piece::kClock:
      return {0.32, 0.02, 1.95, 2.27};
    case Piece::kExtinguisher:
      return {0.2, 0.06, 0.5, 1.05};
    case Piece::kHoseBox:
      return {0.6, 0.2, 0.8, 1.55};
    case Piece::kSwitch:
      return {0.09, 0.01, 1.05, 1.21};
    case Piece::kSocket:
      return {0.22, 0.02, 0.26, 0.36};
    case Piece::kGrille:
      return {0.45, 0.02, 2.3, 2.55};
    case Piece::kSheets:
      return {0.75, 0.02, 1.34, 1.86};
    case Piece::kWallShelf:
      return {0.9, 0.24, 1.38, 1.85};
    case Piece::kDuct:
      return {0.14, 0.08, 0, 2.8};
    case Piece::kWindow:
      return {1.6, 0.2, 0.0, 2.35};
    case Piece::kBookshelf:
      return {0.9, 0.32, 0, 2.0};
    case Piece::kStoreShelf:
      return {1.1, 0.45, 0, 2.0};
    case Piece::kCabinet:
      return {0.8, 0.42, 0, 1.3};
    case Piece::kDesk:
      return {1.5, 1.3, 0, 1.25};
    case Piece::kSofa:
      return {1.8, 0.8, 0, 0.85};
    case Piece::kPlant:
      return {0.6, 0.5, 0, 1.7};
    case Piece::kVending:
      return {0.9, 0.75, 0, 1.85};
    case Piece::kFridge:
      return {0.62, 0.62, 0, 1.8};
    case Piece::kKitchen:
      return {1.8, 0.6, 0, 1.2};
    case Piece::kCopier:
      return {0.65, 0.6, 0, 1.05};
    case Piece::kRack:
      return {0.62, 0.7, 0, 1.9};
    case Piece::kCartons:
      return {1.1, 0.45, 0, 1.1};
    case Piece::kBin:
      return {0.3, 0.3, 0, 0.65};
    case Piece::kBench:
      return {1.4, 0.42, 0, 0.5};
    case Piece::kPillar:
      return {0.4, 0.25, 0, 2.8};
    case Piece::kTable:
      return {2.4, 1.9, 0, 1.0};
    case Piece::kLabBench:
      return {2.2, 0.8, 0, 1.5};
  }
  return {};
}

void build(Builder& b, Piece piece, const WallFrame& f, std::uint64_t design, Random& random) {
  const PieceSize size = size_of(piece);
  const double w = size.width_m;
  const double d = size.depth_m;
  if (d > 0.2 && size.bottom_m < 0.3 && piece != Piece::kWindow) b.block(f, {0, w}, {0, d});
  const Span width{0, w};
  const Span depth{0.01, d};
  switch (piece) {
    case Piece::kPoster:
      hang(b, f, Design::kPoster, design, size, 0.012, random.uniform(-0.08, 0.12));
      break;
    case Piece::kPicture:
      hang(b, f, Design::kPicture, design, size, 0.035, random.uniform(-0.08, 0.12));
      break;
    case Piece::kNoticeBoard:
      hang(b, f, Design::kNoticeBoard, design, size, 0.03, random.uniform(-0.05, 0.1));
      break;
    case Piece::kWhiteboard:
      hang(b, f, Design::kWhiteboard, design, size, 0.03, 0);
      break;
    case Piece::kSign:
      hang(b, f, Design::kSign, design, size, 0.015, 0);
      break;
    case Piece::kHoseBox:
      hang(b, f, Design::kHoseBox, design % 2, size, 0.18, 0);
      break;
    case Piece::kSwitch:
      hang(b, f, Design::kSwitch, 0, size, 0.012, 0);
      break;
    case Piece::kSocket:
      hang(b, f, Design::kSocket, 0, size, 0.015, 0);
      break;
    case Piece::kGrille:
      hang(b, f, Design::kGrille, 0, size, 0.02, 0);
      break;
    case Piece::kSheets:
      for (int i = 0; i < 3; ++i) {
        if (!random.chance(0.8)) continue;
        const double s = 0.25 * i + random.uniform(0, 0.04) + b.wear().shift(0.04);
        const double z = size.bottom_m + random.uniform(0, 0.2) + b.wear().shift(0.1);
        b.panel(f, {s, s + 0.21}, 0.006, {z, z + 0.3},
                b.fitted(Design::kSheet, design * 3 + static_cast<std::uint64_t>(i)));
      }
      break;
    case Piece::kWallShelf: {
      const BoxSkin wood = all_over(b.tiled(Design::kLaminate, design % 7));
      b.box(f, width, {0, d}, {size.bottom_m, size.bottom_m + 0.03}, wood, true);
      things_on_shelf(b, f, size, random);
      break;
    }
    case Piece::kDuct: {
      const BoxSkin metal = all_over(b.tiled(Design::kMetal, 1));
      b.box(f, width, {0, d}, {0, size.top_m}, metal);
      b.panel(f, {0.02, 0.12}, d + 0.004, {1.1, 1.26}, b.fitted(Design::kSwitch, 0));
      b.panel(f, {0.02, 0.12}, d + 0.004, {0.3, 0.46}, b.fitted(Design::kSwitch, 1));
      break;
    }
    case Piece::kClock:
      b.panel(f, width, 0.03, {size.bottom_m, size.top_m}, b.fitted(Design::kClock, design % 6));
      break;
    case Piece::kExtinguisher:
      b.panel(f, width, 0.08, {size.bottom_m, size.top_m}, b.fitted(Design::kExtinguisher, 0));
      b.panel(f, {0, 0.2}, 0.01, {size.top_m + 0.3, size.top_m + 0.5}, b.fitted(Design::kSign, 1));
      break;
    case Piece::kWindow:
      window(b, f, size, design);
      break;
    case Piece::kBookshelf:
      b.box(f, width, depth, {0, size.top_m}, fronted(b, Design::kBookshelf, design));
      break;
    case Piece::kStoreShelf:
      b.box(f, width, depth, {0, size.top_m}, fronted(b, Design::kStoreShelf, design));
      break;
    case Piece::kCabinet:
      b.box(f, width, depth, {0, size.top_m}, fronted(b, Design::kCabinet, design % 10));
      things_on_top(b, f, {0.05, w}, {0.05, d}, size.top_m + 0.002, random.between(0, 3), random);
      break;
    case Piece::kDesk:
      desk(b, f, size, design, random);
      break;
    case Piece::kSofa: {
      const BoxSkin fabric = all_over(b.tiled(Design::kFabric, design % 6));
      const BoxSkin pillow = all_over(b.tiled(Design::kFabric, 7 + design % 5));
      b.box(f, width, {0.02, 0.25}, {0.1, 0.85}, fabric);
      b.box(f, {0, 0.2}, {0.25, d}, {0.1, 0.62}, fabric);
      b.box(f, {w - 0.2, w}, {0.25, d}, {0.1, 0.62}, fabric);
      b.box(f, {0.2, w / 2 - 0.01}, {0.25, d}, {0.1, 0.43}, fabric);
      b.box(f, {w / 2 + 0.01, w - 0.2}, {0.25, d}, {0.1, 0.43}, fabric);
      b.box(f, {0.3, 0.7}, {0.25, 0.37}, {0.43, 0.75}, pillow);
      break;
    }
    case Piece::kPlant:
      plant(b, f, size, design, random);
      break;
    case Piece::kVending: {
      BoxSkin skin = fronted(b, Design::kVending, design % 6);
      skin.front.glow = Glow::kScreen;
      b.box(f, width, depth, {0, size.top_m}, skin);
      break;
    }
    case Piece::kFridge:
      b.box(f, width, depth, {0, size.top_m}, fronted(b, Design::kFridge, design % 12));
      break;
    case Piece::kKitchen:
      b.box(f, width, depth, {0, 0.88}, fronted(b, Design::kKitchen, design % 5));
      b.box(f, {0.05, w - 0.05}, {0.01, 0.35}, {1.5, 2.1}, fronted(b, Design::kCabinet, design % 10), true);
      things_on_top(b, f, {0.05, w - 0.05}, {0.1, d}, 0.882, random.between(3, 6), random);
      break;
    case Piece::kCopier:
      b.box(f, width, depth, {0, 1.0}, fronted(b, Design::kCopier, design % 3));
      break;
    case Piece::kRack: {
      const Skin metal = b.tiled(Design::kMetal, 2);
      b.box(f, width, depth, {0, size.top_m},
            {b.fitted(Design::kRack, b.wear().other(design % 12, 12, 0.7)), metal, metal, metal});
      break;
    }
    case Piece::kCartons:
      cartons(b, f, size, random);
      break;
    case Piece::kBin: {
      const BoxSkin skin = all_over(b.tiled(Design::kPaint, design % 5, 0.5));
      b.box(f, {0, 0.3}, {0.02, 0.3}, {0, 0.6}, skin);
      b.panel(f, {0.06, 0.24}, 0.305, {0.3, 0.45}, b.fitted(Design::kSign, design % 4));
      break;
    }
    case Piece::kBench: {
      const BoxSkin wood = all_over(b.tiled(Design::kLaminate, design % 7));
      b.box(f, width, {0.04, d}, {0.4, 0.46}, wood, true);
      for (const double s : {0.1, w - 0.18}) b.box(f, {s, s + 0.08}, {0.08, d - 0.05}, {0, 0.4}, wood);
      break;
    }
    case Piece::kPillar: {
      const BoxSkin concrete = all_over(b.tiled(Design::kConcrete, design % 2));
      b.box(f, width, {0, d}, {0, size.top_m}, concrete);
      break;
    }
    case Piece::kTable:
      table(b, f, size, design, random);
      break;
    case Piece::kLabBench:
      lab_bench(b, f, size, design, random);
      break;
  }
}

}  // namespace mapweld::rendered
