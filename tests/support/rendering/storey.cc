#include "tests/support/rendering/storey.h"

#include <algorithm>
#include <array>
#include <optional>

#include "tests/support/rendering/lighting.h"
#include "tests/support/rendering/pieces.h"
#include "tests/support/rendering/shell.h"

namespace mapweld::rendered {

Deck::Deck(std::uint64_t seed, int designs, int posters_in_two_places)
    : seed_(seed), designs_(std::max(1, designs)), to_repeat_(posters_in_two_places) {}

std::uint64_t Deck::deal(Design kind, std::uint64_t key) {
  const auto [place, is_new] = places_.try_emplace({kind, key}, 0);
  if (!is_new) return place->second;
  std::vector<std::uint64_t>& cards = cards_[kind];
  std::size_t& dealt = dealt_[kind];
  if (dealt == cards.size()) {
    std::vector<std::uint64_t> more(static_cast<std::size_t>(designs_));
    for (std::size_t i = 0; i < more.size(); ++i) more[i] = i;
    Random random(hash_of(seed_, static_cast<int>(kind), cards.size()));
    random.shuffle(more);
    cards.insert(cards.end(), more.begin(), more.end());
  }
  // Every third poster after the first eight hangs for the second time, as long as any are to be repeated.
  if (kind == Design::kPoster && to_repeat_ > 0 && dealt >= 8 && places_.size() % 3 == 0) {
    --to_repeat_;
    place->second = cards[static_cast<std::size_t>(to_repeat_) % 8];
  } else {
    place->second = cards[dealt++];
  }
  return place->second;
}

namespace {

struct Choice {
  Piece piece;
  int weight;
};
constexpr std::array<Choice, 16> kCorridorPieces{{{Piece::kPoster, 30},
                                                  {Piece::kPicture, 12},
                                                  {Piece::kNoticeBoard, 16},
                                                  {Piece::kPlant, 7},
                                                  {Piece::kCabinet, 5},
                                                  {Piece::kBookshelf, 5},
                                                  {Piece::kBench, 5},
                                                  {Piece::kExtinguisher, 6},
                                                  {Piece::kHoseBox, 4},
                                                  {Piece::kSign, 4},
                                                  {Piece::kPillar, 4},
                                                  {Piece::kBin, 4},
                                                  {Piece::kCartons, 3},
                                                  {Piece::kWhiteboard, 2},
                                                  {Piece::kClock, 2},
                                                  {Piece::kStoreShelf, 2}}};

Piece choose_corridor_piece(Random& random) {
  int total = 0;
  for (const Choice& choice : kCorridorPieces) total += choice.weight;
  int ticket = random.below(total);
  for (const Choice& choice : kCorridorPieces) {
    ticket -= choice.weight;
    if (ticket < 0) return choice.piece;
  }
  return Piece::kPoster;
}

std::vector<Piece> pieces_of(RoomKind kind, Random& random) {
  std::vector<Piece> pieces;
  const auto some = [&](Piece piece, int low, int high) {
    const int count = random.between(low, high);
    for (int i = 0; i < count; ++i) pieces.push_back(piece);
  };
  switch (kind) {
    case RoomKind::kOffice:
      some(Piece::kDesk, 1, 3);
      some(Piece::kBookshelf, 1, 2);
      some(Piece::kCabinet, 0, 1);
      some(Piece::kWhiteboard, 0, 1);
      some(Piece::kPlant, 0, 1);
      some(Piece::kPoster, 1, 3);
      some(Piece::kBin, 1, 1);
      some(Piece::kNoticeBoard, 0, 1);
      break;
    case RoomKind::kMeeting:
      some(Piece::kTable, 1, 1);
      some(Piece::kWhiteboard, 1, 1);
      some(Piece::kPicture, 1, 3);
      some(Piece::kCabinet, 0, 1);
      some(Piece::kPlant, 1, 1);
      some(Piece::kPoster, 0, 2);
      break;
    case RoomKind::kKitchen:
      some(Piece::kKitchen, 1, 1);
      some(Piece::kFridge, 1, 1);
      some(Piece::kTable, 0, 1);
      some(Piece::kVending, 0, 1);
      some(Piece::kNoticeBoard, 1, 1);
      some(Piece::kSofa, 0, 1);
      some(Piece::kPoster, 1, 2);
      some(Piece::kBin, 1, 1);
      break;
    case RoomKind::kLibrary:
      some(Piece::kBookshelf, 4, 7);
      some(Piece::kSofa, 1, 1);
      some(Piece::kPlant, 0, 1);
      some(Piece::kPicture, 1, 2);
      break;
    case RoomKind::kLaboratory:
      some(Piece::kLabBench, 1, 2);
      some(Piece::kRack, 1, 3);
      some(Piece::kStoreShelf, 0, 1);
      some(Piece::kDesk, 0, 1);
      some(Piece::kWhiteboard, 0, 1);
      some(Piece::kPoster, 1, 2);
      some(Piece::kSign, 1, 2);
      break;
    case RoomKind::kStore:
      some(Piece::kStoreShelf, 3, 5);
      some(Piece::kCartons, 1, 2);
      some(Piece::kRack, 0, 1);
      some(Piece::kCopier, 1, 1);
      some(Piece::kPoster, 0, 1);
      break;
  }
  some(Piece::kClock, 0, 1);
  return pieces;
}

bool overlap(const Area& a, const Area& b) { return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1; }

// One storey in the making.
class Mason {
 public:
  Mason(const FloorPlan& plan, const StoreyOptions& options, Catalogue& catalogue, Deck& deck)
      : plan_(plan), options_(options), catalogue_(catalogue), deck_(deck) {}

  Storey build() {
    number_cells();
    for (std::size_t k = 0; k < plan_.corridors.size(); ++k) build_corridor(static_cast<int>(k));
    for (std::size_t side = 0; side < plan_.cross_corridors.size(); ++side) build_cross(static_cast<int>(side));
    for (std::size_t r = 0; r < plan_.rooms.size(); ++r) {
      if (plan_.rooms[r].open) build_room(static_cast<int>(r));
    }
    light_scene(storey_.scene);
    return std::move(storey_);
  }

 private:
  void number_cells() {
    for (const Area& area : plan_.corridors) add_cell(area);
    for (const Area& area : plan_.cross_corridors) add_cell(area);
    for (const Room& room : plan_.rooms) {
      storey_.room_cells.push_back(room.open ? static_cast<int>(storey_.scene.cells.size()) : -1);
      if (room.open) add_cell(room.area);
    }
  }
  void add_cell(const Area& area) {
    Cell cell;
    cell.area = area;
    cell.height_m = plan_.storey_height_m;
    storey_.scene.cells.push_back(std::move(cell));
  }
  Cell& cell(int index) { return storey_.scene.cells[static_cast<std::size_t>(index)]; }

  // The seed of a place in a corridor: its own, or that of the same place in the first corridor, or on the ground
  // floor.
  std::uint64_t place_seed(int corridor, int side, int place) const {
    Random own(hash_of(options_.seed, 31, options_.storey, corridor, side, place));
    const bool like_first = own.chance(options_.look_alike_corridors) && corridor < 1000;
    const bool like_ground = own.chance(options_.look_alike_storeys);
    return hash_of(options_.seed, 32, like_ground ? 0 : options_.storey, like_first ? 0 : corridor, side, place);
  }
  std::uint64_t design_of(Piece piece, std::uint64_t key, Random& random) {
    switch (piece) {
      case Piece::kPoster:
        return deck_.deal(Design::kPoster, key);
      case Piece::kPicture:
        return deck_.deal(Design::kPicture, key);
      case Piece::kNoticeBoard:
        return deck_.deal(Design::kNoticeBoard, key);
      case Piece::kWhiteboard:
        return deck_.deal(Design::kWhiteboard, key);
      case Piece::kBookshelf:
        return deck_.deal(Design::kBookshelf, key);
      case Piece::kStoreShelf:
        return deck_.deal(Design::kStoreShelf, key);
      case Piece::kWindow:
        return deck_.deal(Design::kWindow, key);
      default:
        return static_cast<std::uint64_t>(random.below(60));
    }
  }

  // Builds the piece with its left end at s, if the place is free.
  bool place(Builder& builder, Wall& wall, Piece piece, double s, std::uint64_t key, Random& random,
             const Area* lane = nullptr) {
    const PieceSize size = size_of(piece);
    const Span along{s - 0.06, s + size.width_m + 0.06};
    const Span up{size.bottom_m, size.top_m};
    if (!wall.is_free(along, up)) return false;
    const WallFrame at = wall.frame.moved(s, 0);
    if (size.depth_m > 0.2 || lane != nullptr) {
      Cell probe;
      Builder measure(catalogue_, probe);
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
    const std::uint64_t design = design_of(piece, key, random);
    mapweld::rendered::build(builder, piece, at, design, random);
    if (piece == Piece::kPoster) {
      storey_.posters.push_back({design, at.at(size.width_m / 2, 0, (size.bottom_m + size.top_m) / 2), at.out});
    }
    return true;
  }

  std::uint64_t reference_corridor(int corridor) const {
    return options_.look_alike_corridors > 0 ? 0 : static_cast<std::uint64_t>(corridor) + 1;
  }

  ShellDesigns corridor_designs(int corridor) const {
    Random random(hash_of(options_.seed, 41, reference_corridor(corridor)));
    ShellDesigns designs;
    designs.wall = static_cast<std::uint64_t>(random.below(24));
    designs.floor = hash_of(options_.seed, 42) % 12;
    designs.paint = static_cast<std::uint64_t>(random.below(12));
    return designs;
  }

  void dress(Builder& builder, Wall& wall, int corridor, int side) {
    double s = 0.4;
    for (int i = 0; s < wall.length_m - 0.6; ++i) {
      const std::uint64_t key = place_seed(corridor, side, i);
      Random random(key);
      const Piece piece = choose_corridor_piece(random);
      const double shift = random.uniform(0, 0.4);
      if (place(builder, wall, piece, s + shift, key, random)) {
        s += shift + size_of(piece).width_m + random.uniform(0.25, 0.8);
      } else if (place(builder, wall, Piece::kPoster, s + shift, key, random)) {
        s += shift + 0.59 + random.uniform(0.25, 0.6);
      } else {
        s += 0.55;
      }
    }
  }

  void build_corridor(int k) {
    const Area& area = plan_.corridors[static_cast<std::size_t>(k)];
    Builder builder(catalogue_, cell(k));
    const ShellDesigns designs = corridor_designs(k);
    Random look(hash_of(options_.seed, 43, reference_corridor(k)));
    const std::array<std::uint64_t, 2> doors{static_cast<std::uint64_t>(look.below(40)),
                                             static_cast<std::uint64_t>(look.below(40))};
    std::array<Wall, 4> walls{wall_of(area, Side::kSouth), wall_of(area, Side::kNorth), wall_of(area, Side::kWest),
                              wall_of(area, Side::kEast)};
    for (std::size_t r = 0; r < plan_.rooms.size(); ++r) {
      const Room& room = plan_.rooms[r];
      if (room.corridor != k) continue;
      Wall& wall = walls[room.north ? 1 : 0];
      const double s = along_wall(area, room.north ? Side::kNorth : Side::kSouth, room.door_x_m);
      const double half = plan_.door_width_m / 2;
      wall.taken.push_back({{s - half - 0.12, s + half + 0.12}, {0, plan_.door_height_m + 0.12}});
      if (room.open) {
        wall.openings.push_back({{s - half, s + half}, plan_.door_height_m, storey_.room_cells[r], plan_.wall_m / 2});
      }
      build_door(builder, wall.frame, s, plan_.door_width_m, plan_.door_height_m, designs, !room.open,
                 doors[static_cast<std::size_t>(room.number / 2 % 2)]);
      const auto number = static_cast<std::uint64_t>(options_.storey * 1000 + (k + 1) * 100 + room.number);
      builder.panel(wall.frame, {s + half + 0.14, s + half + 0.36}, 0.01, {1.45, 1.61},
                    builder.fitted(Design::kDoorPlate, number));
      wall.taken.push_back({{s + half + 0.12, s + half + 0.38}, {1.4, 1.66}});
    }
    const bool cross = !plan_.cross_corridors.empty();
    for (const std::size_t end : {std::size_t{2}, std::size_t{3}}) {
      Wall& wall = walls[end];
      if (cross) {
        const int to = static_cast<int>(plan_.corridors.size() + (end == 2 ? 0 : 1));
        wall.openings.push_back({{0, wall.length_m}, plan_.storey_height_m, to, 0});
      } else if (end == 2) {
        Random random(place_seed(k, 2, 0));
        place(builder, wall, Piece::kWindow, wall.length_m / 2 - 0.8, place_seed(k, 2, 0), random);
      } else {
        build_door(builder, wall.frame, wall.length_m / 2, plan_.door_width_m, plan_.door_height_m, designs, true,
                   doors[0]);
        const Skin sign = builder.fitted(Design::kExitSign, 0, Glow::kScreen);
        builder.panel(wall.frame, {wall.length_m / 2 - 0.22, wall.length_m / 2 + 0.22}, 0.02, {2.3, 2.5}, sign);
      }
    }
    dress(builder, walls[0], k, 0);
    dress(builder, walls[1], k, 1);
    hang_exit_signs(builder, area);
    finish(builder, walls, designs, 2.6, 1);
  }

  void hang_exit_signs(Builder& builder, const Area& area) {
    const Skin sign = builder.fitted(Design::kExitSign, options_.seed % 4, Glow::kScreen);
    const Skin edge = builder.tiled(Design::kMetal, 0);
    for (double x = area.x0 + 4; x < area.x1 - 2; x += 9) {
      const WallFrame frame = WallFrame::facing({x, (area.y0 + area.y1) / 2, 0}, {-1, 0, 0});
      builder.box(frame, {-0.22, 0.22}, {-0.02, 0.02}, {2.42, 2.62}, {sign, edge, edge, sign}, true);
      builder.box(frame, {-0.01, 0.01}, {-0.01, 0.01}, {2.62, 2.8}, all_over(edge));
    }
  }

  void build_cross(int side) {
    const int index = static_cast<int>(plan_.corridors.size()) + side;
    const Area& area = plan_.cross_corridors[static_cast<std::size_t>(side)];
    Builder builder(catalogue_, cell(index));
    const int name = 1000 + side;  // cross corridors look like nothing else
    const ShellDesigns designs = corridor_designs(name);
    std::array<Wall, 4> walls{wall_of(area, Side::kSouth), wall_of(area, Side::kNorth), wall_of(area, Side::kWest),
                              wall_of(area, Side::kEast)};
    const Side inner_side = side == 0 ? Side::kEast : Side::kWest;
    Wall& inner = walls[side == 0 ? 3 : 2];
    Wall& outer = walls[side == 0 ? 2 : 3];
    for (std::size_t k = 0; k < plan_.corridors.size(); ++k) {
      const Area& corridor = plan_.corridors[k];
      const double a = along_wall(area, inner_side, corridor.y0);
      const double b = along_wall(area, inner_side, corridor.y1);
      const Span s{std::min(a, b), std::max(a, b)};
      inner.openings.push_back({s, plan_.storey_height_m, static_cast<int>(k), 0});
      inner.taken.push_back({s, {0, plan_.storey_height_m}});
    }
    Random random(hash_of(options_.seed, 44, options_.storey, side));
    for (double s = 1.2; s < outer.length_m - 1.7; s += 4.5) {
      place(builder, outer, Piece::kWindow, s, hash_of(options_.seed, 45, side, s), random);
    }
    for (std::size_t end = 0; end < 2; ++end) {
      build_door(builder, walls[end].frame, walls[end].length_m / 2, plan_.door_width_m, plan_.door_height_m, designs,
                 true, static_cast<std::uint64_t>(random.below(40)));
      const double middle = walls[end].length_m / 2;
      walls[end].taken.push_back({{middle - 0.62, middle + 0.62}, {0, 2.2}});
    }
    dress(builder, outer, name, 0);
    dress(builder, inner, name, 1);
    finish(builder, walls, designs, 2.6, 1);
  }

  void build_room(int r) {
    const Room& room = plan_.rooms[static_cast<std::size_t>(r)];
    const int index = storey_.room_cells[static_cast<std::size_t>(r)];
    Builder builder(catalogue_, cell(index));
    Random own(hash_of(room.seed, 51, options_.storey));
    const bool like_ground = own.chance(options_.look_alike_storeys);
    Random random(hash_of(room.seed, 52, like_ground ? 0 : options_.storey));
    ShellDesigns designs;
    designs.wall = static_cast<std::uint64_t>(random.below(60));
    designs.floor = static_cast<std::uint64_t>(random.below(12));
    designs.paint = corridor_designs(room.corridor).paint;

    std::array<Wall, 4> walls{wall_of(room.area, Side::kSouth), wall_of(room.area, Side::kNorth),
                              wall_of(room.area, Side::kWest), wall_of(room.area, Side::kEast)};
    const Side door_side = room.north ? Side::kSouth : Side::kNorth;
    Wall& door_wall = walls[room.north ? 0 : 1];
    Wall& back_wall = walls[room.north ? 1 : 0];
    const double s = along_wall(room.area, door_side, room.door_x_m);
    const double half = plan_.door_width_m / 2;
    door_wall.openings.push_back({{s - half, s + half}, plan_.door_height_m, room.corridor, plan_.wall_m / 2});
    door_wall.taken.push_back({{s - half - 0.12, s + half + 0.12}, {0, plan_.door_height_m + 0.1}});
    build_door(builder, door_wall.frame, s, plan_.door_width_m, plan_.door_height_m, designs, false, 0);
    build_open_leaf(builder, door_wall, s, half, random);
    place(builder, door_wall, Piece::kSwitch, s - half - 0.4, 0, random);

    const Area look = room.lookout();
    const double reach = 0.75;
    const Area lane{look.x0 - reach, room.north ? room.area.y0 : look.y0 - reach, look.x0 + reach,
                    room.north ? look.y0 + reach : room.area.y1};

    const bool outer = room.north ? room.corridor + 1 == static_cast<int>(plan_.corridors.size()) : room.corridor == 0;
    if (outer) {
      for (double at = 0.4; at + 1.7 < back_wall.length_m; at += 2.1) {
        place(builder, back_wall, Piece::kWindow, at, hash_of(room.seed, 53, at * 10), random, &lane);
      }
    }
    int number = 0;
    for (const Piece piece : pieces_of(room.kind, random)) {
      const std::uint64_t key = hash_of(room.seed, 54, like_ground ? 0 : options_.storey, number++);
      if (piece == Piece::kTable || piece == Piece::kLabBench) {
        place_in_the_middle(builder, room, piece, lane, random);
        continue;
      }
      for (int attempt = 0; attempt < 24; ++attempt) {
        Wall& wall = walls[static_cast<std::size_t>(random.below(4))];
        const double free = wall.length_m - size_of(piece).width_m - 0.3;
        const double at = 0.15 + random.uniform() * std::max(0.0, free);
        if (place(builder, wall, piece, at, key, random, &lane)) break;
      }
    }
    finish(builder, walls, designs, 2.4, room.area.width() > 4.4 ? 2 : 1);
  }

  void build_open_leaf(Builder& builder, Wall& wall, double s, double half, Random& random) {
    const bool left = random.chance(0.5);
    const double low = left ? s - half - 0.05 : s + half + 0.01;
    const Skin leaf = builder.fitted(Design::kDoor, static_cast<std::uint64_t>(random.below(40)));
    const Skin edge = builder.tiled(Design::kPaint, 1, 0.5);
    builder.box(wall.frame, {low, low + 0.04}, {0.04, 0.92}, {0.01, 2.05}, {edge, leaf, edge, edge});
    wall.taken.push_back({{low - 0.1, low + 0.15}, {0, 2.1}});
    builder.block(wall.frame, {low, low + 0.06}, {0.0, 0.95});
  }

  void place_in_the_middle(Builder& builder, const Room& room, Piece piece, const Area& lane, Random& random) {
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

  template <std::size_t N>
  void finish(Builder& builder, const std::array<Wall, N>& walls, const ShellDesigns& designs, double lamp_pitch,
              int lamp_rows) {
    for (const Wall& wall : walls) build_wall(builder, wall, designs);
    build_floor_and_ceiling(builder, designs);
    build_lamps(builder, lamp_pitch, lamp_rows);
  }

  const FloorPlan& plan_;
  const StoreyOptions& options_;
  Catalogue& catalogue_;
  Deck& deck_;
  Storey storey_;
};

}  // namespace

Storey build_storey(const FloorPlan& plan, const StoreyOptions& options, Catalogue& catalogue, Deck& deck) {
  return Mason(plan, options, catalogue, deck).build();
}

}  // namespace mapweld::rendered
