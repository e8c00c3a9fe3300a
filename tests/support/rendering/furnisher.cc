#include "tests/support/rendering/furnisher.h"

#include <algorithm>

#include "tests/support/rendering/choices.h"

namespace mapweld::rendered {
namespace {

bool overlap(const Area& a, const Area& b) { return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1; }

// Notices and what people carry about.
bool can_be_gone(Piece piece) {
  switch (piece) {
    case Piece::kPoster:
    case Piece::kPicture:
    case Piece::kNoticeBoard:
    case Piece::kWhiteboard:
    case Piece::kSheets:
    case Piece::kPlant:
    case Piece::kCartons:
    case Piece::kBin:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::uint64_t Furnisher::place_seed(int corridor, int side, int place) const {
  Random own(hash_of(options_.seed, 31, options_.storey, corridor, side, place));
  const bool like_first = own.chance(options_.look_alike_corridors) && corridor < kUnlike;
  const bool like_ground = own.chance(options_.look_alike_storeys);
  return hash_of(options_.seed, 32, like_ground ? 0 : options_.storey, like_first ? 0 : corridor, side, place);
}

std::uint64_t Furnisher::design_of(Piece piece, std::uint64_t key, Random& random, Wear& wear) {
  // Wear: by this probability another one than was there when all was new.
  const auto deal = [&](Design kind, double other) { return deck_.deal(kind, wear.other_place(key, other)); };
  switch (piece) {
    case Piece::kPoster:
      return deal(Design::kPoster, 0.75);
    case Piece::kPicture:
      return deal(Design::kPicture, 0.75);
    case Piece::kNoticeBoard:
      return deal(Design::kNoticeBoard, 1);
    case Piece::kWhiteboard:
      return deal(Design::kWhiteboard, 1);
    case Piece::kBookshelf:
      return deal(Design::kBookshelf, 1);
    case Piece::kStoreShelf:
      return deal(Design::kStoreShelf, 1);
    case Piece::kWindow:
      return deal(Design::kWindow, 0.5);
    case Piece::kSheets:
      return deal(Design::kSheet, 1);
    default:
      return static_cast<std::uint64_t>(random.below(60));
  }
}

bool Furnisher::place(Builder& builder, Wall& wall, Piece piece, double s, std::uint64_t key, Random& random,
                      const Area* lane) {
  const PieceSize size = size_of(piece);
  const Span along{s - 0.06, s + size.width_m + 0.06};
  const Span up{size.bottom_m, size.top_m};
  if (!wall.is_free(along, up)) return false;
  const WallFrame at = wall.frame.moved(s, 0);
  if (size.depth_m > 0.2 || lane != nullptr) {
    Cell probe;
    Builder measure(builder, probe);
    measure.block(at, {-0.03, size.width_m + 0.03}, {0, size.depth_m + 0.03});
    const Area& area = probe.footprints.front();
    if (lane != nullptr && size.depth_m > 0.2 && overlap(area, *lane)) return false;
    const bool stands = size.bottom_m < 0.3;
    if (stands && piece != Piece::kWindow &&
        std::any_of(builder.cell().footprints.begin(), builder.cell().footprints.end(),
                    [&](const Area& other) { return overlap(area, other); })) {
      return false;
    }
  }
  wall.taken.push_back({along, up});
  const std::uint64_t design = design_of(piece, key, random, builder.wear());
  if (can_be_gone(piece) && builder.wear().happens(0.15)) {
    // Its numbers are drawn all the same: what comes after it stays where it is.
    Cell nowhere;
    Builder gone(builder, nowhere);
    mapweld::rendered::build(gone, piece, at, design, random);
    return true;
  }
  mapweld::rendered::build(builder, piece, at, design, random);
  if (piece == Piece::kPoster) {
    posters_.push_back({design, at.at(size.width_m / 2, 0, (size.bottom_m + size.top_m) / 2), at.out});
  }
  return true;
}

void Furnisher::dress(Builder& builder, Wall& wall, int corridor, int side) {
  double s = 0.4;
  for (int i = 0; s < wall.length_m - 0.6; ++i) {
    const std::uint64_t key = place_seed(corridor, side, i);
    Random random(key);
    const Piece piece = choose_corridor_piece(random);
    const double shift = random.uniform(0, 0.25);
    if (place(builder, wall, piece, s + shift, key, random)) {
      s += shift + size_of(piece).width_m + random.uniform(0.05, 0.35);
    } else if (place(builder, wall, Piece::kPoster, s + shift, key, random)) {
      s += shift + 0.59 + random.uniform(0.05, 0.3);
    } else {
      s += 0.4;
    }
  }
  // Above what stands, below what hangs.
  int number = 100;
  for (double at = 0.3; at < wall.length_m - 0.8; at += 0.36) {
    const std::uint64_t key = place_seed(corridor, side, number++);
    Random random(key);
    const Piece piece = choose_small_corridor_piece(random);
    const double shift = random.uniform(0, 0.2);
    if (random.chance(0.85)) place(builder, wall, piece, at + shift, key, random);
    if (random.chance(0.45)) place(builder, wall, Piece::kSocket, at + shift, key, random);
    if (random.chance(0.12)) place(builder, wall, Piece::kGrille, at, key, random);
  }
}

void Furnisher::place_in_the_middle(Builder& builder, const Room& room, Piece piece, const Area& lane, Random& random) {
  const PieceSize size = size_of(piece);
  for (int attempt = 0; attempt < 16; ++attempt) {
    const bool east_west = random.chance(0.6);
    const double w = east_west ? size.width_m : size.depth_m;
    const double d = east_west ? size.depth_m : size.width_m;
    if (w > room.area.width() - 0.8 || d > room.area.height() - 0.8) continue;
    const double x = random.uniform(room.area.x0 + 0.4, room.area.x1 - 0.4 - w);
    const double y = random.uniform(room.area.y0 + 0.4, room.area.y1 - 0.4 - d);
    const Area area{x, y, x + w, y + d};
    if (overlap(area, lane) || std::any_of(builder.cell().footprints.begin(), builder.cell().footprints.end(),
                                           [&](const Area& other) { return overlap(area, other); })) {
      continue;
    }
    const WallFrame frame =
        east_west ? WallFrame::facing({x, y + d, 0}, {0, -1, 0}) : WallFrame::facing({x, y, 0}, {1, 0, 0});
    mapweld::rendered::build(builder, piece, frame, static_cast<std::uint64_t>(random.below(60)), random);
    return;
  }
}

}  // namespace mapweld::rendered
