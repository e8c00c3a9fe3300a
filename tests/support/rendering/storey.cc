#include "tests/support/rendering/storey.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tests/support/rendering/choices.h"
#include "tests/support/rendering/lighting.h"
#include "tests/support/rendering/pieces.h"
#include "tests/support/rendering/shell.h"

namespace mapweld::rendered {

namespace {

// One storey in the making.
class Mason {
 public:
  Mason(const FloorPlan& plan, const StoreyOptions& options, Catalogue& catalogue, Deck& deck)
      : plan_(plan),
        options_(options),
        catalogue_(catalogue),
        furnisher_(options, catalogue, deck),
        wear_(options.worn_copies, options.seed, options.storey) {}

  Storey build() {
    number_cells();
    for (std::size_t k = 0; k < plan_.corridors.size(); ++k) build_corridor(static_cast<int>(k));
    for (std::size_t side = 0; side < plan_.cross_corridors.size(); ++side) build_cross(static_cast<int>(side));
    for (std::size_t r = 0; r < plan_.rooms.size(); ++r) {
      if (plan_.rooms[r].open) build_room(static_cast<int>(r));
    }
    light_scene(storey_.scene);
    wear_.shade(storey_.scene);
    storey_.posters = furnisher_.posters();
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

  std::uint64_t reference_corridor(int corridor) const {
    return options_.look_alike_corridors > 0 ? 0 : static_cast<std::uint64_t>(corridor) + 1;
  }

  ShellDesigns corridor_designs(int corridor) const {
    Random random(hash_of(options_.seed, 41, reference_corridor(corridor)));
    ShellDesigns designs;
    designs.wall = static_cast<std::uint64_t>(random.below(24));
    designs.floor = hash_of(options_.seed, 42) % 12;
    designs.paint = static_cast<std::uint64_t>(random.below(12));
    designs.ceiling = static_cast<std::uint64_t>(random.below(4));
    designs.offset = random.uniform();
    return designs;
  }

  void build_corridor(int k) {
    const Area& area = plan_.corridors[static_cast<std::size_t>(k)];
    Builder builder(catalogue_, cell(k), wear_);
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
        Random random(furnisher_.place_seed(k, 2, 0));
        furnisher_.place(builder, wall, Piece::kWindow, wall.length_m / 2 - 0.8, furnisher_.place_seed(k, 2, 0),
                         random);
      } else {
        build_door(builder, wall.frame, wall.length_m / 2, plan_.door_width_m, plan_.door_height_m, designs, true,
                   doors[0]);
        const Skin sign = builder.fitted(Design::kExitSign, 0, Glow::kScreen);
        builder.panel(wall.frame, {wall.length_m / 2 - 0.22, wall.length_m / 2 + 0.22}, 0.02, {2.3, 2.5}, sign);
      }
    }
    furnisher_.dress(builder, walls[0], k, 0);
    furnisher_.dress(builder, walls[1], k, 1);
    hang_exit_signs_and_cables(builder, area, hash_of(options_.seed, 47, reference_corridor(k)));
    finish(builder, walls, designs, 2.6, 1, reference_corridor(k));
  }

  void hang_exit_signs_and_cables(Builder& builder, const Area& area, std::uint64_t look) {
    const Skin sign = builder.fitted(Design::kExitSign, options_.seed % 4, Glow::kScreen);
    const Skin edge = builder.tiled(Design::kMetal, 0);
    for (double x = area.x0 + 4; x < area.x1 - 2; x += 9) {
      const WallFrame frame = WallFrame::facing({x, (area.y0 + area.y1) / 2, 0}, {-1, 0, 0});
      builder.box(frame, {-0.22, 0.22}, {-0.02, 0.02}, {2.42, 2.62}, {sign, edge, edge, sign}, true);
      builder.box(frame, {-0.01, 0.01}, {-0.01, 0.01}, {2.62, 2.8}, all_over(edge));
    }
    // A tray of cables along one side, a pipe along the other.
    const WallFrame frame = WallFrame::facing({area.x0, area.y1, 0}, {0, -1, 0});
    Skin cables = builder.tiled(Design::kCables, hash_of(look, 1) % 5, 1.0);
    cables.tile_down_m = 0.16;
    const BoxSkin pipe = all_over(builder.tiled(Design::kPaint, 5, 0.5));
    const double length = area.width();
    const double across = area.height();
    for (double s = 0.05; s < length - 0.1; s += 2.0) {
      const Span run{s, std::min(s + 2.0, length - 0.05)};
      cables.u_offset = static_cast<double>(hash_of(options_.seed, look, s * 10) % 100) * 0.01;
      builder.box(frame, run, {0.12, 0.34}, {2.5, 2.66}, {cables, edge, edge, cables}, true);
      builder.box(frame, run, {across - 0.2, across - 0.12}, {2.6, 2.68}, pipe, true);
      builder.box(frame, {s, s + 0.06}, {across - 0.23, across - 0.09}, {2.57, 2.8}, all_over(edge), true);
      builder.box(frame, {s, s + 0.04}, {0.1, 0.36}, {2.47, 2.8}, all_over(edge), true);
    }
  }

  void build_cross(int side) {
    const int index = static_cast<int>(plan_.corridors.size()) + side;
    const Area& area = plan_.cross_corridors[static_cast<std::size_t>(side)];
    Builder builder(catalogue_, cell(index), wear_);
    const int name = Furnisher::kUnlike + side;
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
    Random random(furnisher_.place_seed(name, 2, 0));
    for (double s = 1.2; s < outer.length_m - 1.7; s += 4.5) {
      furnisher_.place(builder, outer, Piece::kWindow, s, hash_of(options_.seed, 45, side, s), random);
    }
    for (std::size_t end = 0; end < 2; ++end) {
      build_door(builder, walls[end].frame, walls[end].length_m / 2, plan_.door_width_m, plan_.door_height_m, designs,
                 true, static_cast<std::uint64_t>(random.below(40)));
      const double middle = walls[end].length_m / 2;
      walls[end].taken.push_back({{middle - 0.62, middle + 0.62}, {0, 2.2}});
    }
    furnisher_.dress(builder, outer, name, 0);
    furnisher_.dress(builder, inner, name, 1);
    finish(builder, walls, designs, 2.6, 1, static_cast<std::uint64_t>(name));
  }

  void build_room(int r) {
    const Room& room = plan_.rooms[static_cast<std::size_t>(r)];
    const int index = storey_.room_cells[static_cast<std::size_t>(r)];
    Builder builder(catalogue_, cell(index), wear_);
    Random own(hash_of(room.seed, 51, options_.storey));
    const bool like_ground = own.chance(options_.look_alike_storeys);
    Random random(hash_of(room.seed, 52, like_ground ? 0 : options_.storey));
    ShellDesigns designs;
    designs.wall = static_cast<std::uint64_t>(random.below(60));
    designs.floor = static_cast<std::uint64_t>(random.below(12));
    designs.paint = corridor_designs(room.corridor).paint;
    designs.ceiling = static_cast<std::uint64_t>(random.below(4));
    designs.offset = random.uniform();

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
    furnisher_.place(builder, door_wall, Piece::kSwitch, s - half - 0.4, 0, random);

    const Area look = room.lookout();
    const double reach = 0.75;
    const Area lane{look.x0 - reach, room.north ? room.area.y0 : look.y0 - reach, look.x0 + reach,
                    room.north ? look.y0 + reach : room.area.y1};

    const bool outer = room.north ? room.corridor + 1 == static_cast<int>(plan_.corridors.size()) : room.corridor == 0;
    if (outer) {
      for (double at = 0.4; at + 1.7 < back_wall.length_m; at += 2.1) {
        furnisher_.place(builder, back_wall, Piece::kWindow, at, hash_of(room.seed, 53, at * 10), random, &lane);
      }
    }
    int number = 0;
    for (const Piece piece : choose_room_pieces(room.kind, random)) {
      const std::uint64_t key = hash_of(room.seed, 54, like_ground ? 0 : options_.storey, number++);
      if (piece == Piece::kTable || piece == Piece::kLabBench) {
        furnisher_.place_in_the_middle(builder, room, piece, lane, random);
        continue;
      }
      for (int attempt = 0; attempt < 24; ++attempt) {
        Wall& wall = walls[static_cast<std::size_t>(random.below(4))];
        const double free = wall.length_m - size_of(piece).width_m - 0.3;
        const double at = 0.15 + random.uniform() * std::max(0.0, free);
        if (furnisher_.place(builder, wall, piece, at, key, random, &lane)) break;
      }
    }
    finish(builder, walls, designs, 2.4, room.area.width() > 4.4 ? 2 : 1, room.seed);
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

  template <std::size_t N>
  void finish(Builder& builder, const std::array<Wall, N>& walls, const ShellDesigns& designs, double lamp_pitch,
              int lamp_rows, std::uint64_t ceiling) {
    for (const Wall& wall : walls) {
      build_wall(builder, wall, designs);
      wear_.mark_wall(builder, wall);
    }
    build_floor_and_ceiling(builder, designs);
    wear_.mark_floor_and_ceiling(builder);
    build_lamps(builder, lamp_pitch, lamp_rows);
    build_ceiling_things(builder, hash_of(options_.seed, 46, ceiling));
  }

  const FloorPlan& plan_;
  const StoreyOptions& options_;
  Catalogue& catalogue_;
  Furnisher furnisher_;
  Wear wear_;
  Storey storey_;
};

}  // namespace

Storey build_storey(const FloorPlan& plan, const StoreyOptions& options, Catalogue& catalogue, Deck& deck) {
  return Mason(plan, options, catalogue, deck).build();
}

}  // namespace mapweld::rendered
