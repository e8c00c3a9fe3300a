#include "tests/support/rendering/floor_plan.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
namespace {

constexpr double kCorridorWidth = 2.2;
constexpr double kCrossWidth = 2.4;
constexpr double kRoomDepth = 4.6;

// Rooms along one side of a corridor.
void add_row(FloorPlan& plan, const FloorPlanOptions& options, int corridor, bool north, double y0, double y1) {
  const std::uint64_t like = options.same_corridors ? 0 : static_cast<std::uint64_t>(corridor) + 1;
  Random layout(hash_of(options.seed, 11, like, north));
  Random own(hash_of(options.seed, 12, corridor, north));
  constexpr std::array<RoomKind, 9> kKinds{RoomKind::kOffice,  RoomKind::kOffice,     RoomKind::kMeeting,
                                           RoomKind::kKitchen, RoomKind::kLibrary,    RoomKind::kLaboratory,
                                           RoomKind::kOffice,  RoomKind::kLaboratory, RoomKind::kStore};
  const double length = options.corridor_length_m;
  int number = north ? 1 : 0;
  double x = 0;
  while (length - x > 2.5) {
    double width = layout.uniform(3.6, 6.2);
    if (length - x - width < 3.4) width = length - x;
    if (width > 7.0) width /= 2;
    Room room;
    room.area = {x + plan.wall_m / 2, y0, x + width - plan.wall_m / 2, y1};
    room.corridor = corridor;
    room.north = north;
    const double margin = plan.door_width_m / 2 + 0.35;
    room.door_x_m = layout.uniform(room.area.x0 + margin, room.area.x1 - margin);
    room.open = layout.chance(options.open_rooms);
    room.kind = kKinds[static_cast<std::size_t>(layout.below(static_cast<int>(kKinds.size())))];
    room.number = number;
    room.seed = own.next();
    number += 2;
    plan.rooms.push_back(room);
    x += width;
  }
}

}  // namespace

Area Room::lookout() const {
  const double y = north ? area.y0 + 1.5 : area.y1 - 1.5;
  return {door_x_m, y, door_x_m, y};
}

FloorPlan make_floor_plan(const FloorPlanOptions& options) {
  if (options.corridors < 1 || options.corridors > 64 || !(options.corridor_length_m >= 6) ||
      !(options.corridor_length_m <= 200)) {
    throw std::invalid_argument("a storey has 1 to 64 corridors of 6 to 200 m");
  }
  FloorPlan plan;
  double y = 0;
  for (int k = 0; k < options.corridors; ++k) {
    const double south = y + plan.wall_m / 2;
    const double corridor = y + kRoomDepth + plan.wall_m;
    const double north = corridor + kCorridorWidth;
    add_row(plan, options, k, false, south, corridor - plan.wall_m);
    plan.corridors.push_back({0, corridor, options.corridor_length_m, north});
    add_row(plan, options, k, true, north + plan.wall_m, north + plan.wall_m + kRoomDepth - plan.wall_m / 2);
    y = north + plan.wall_m + kRoomDepth;
  }
  if (options.corridors > 1) {
    const double y0 = plan.corridors.front().y0;
    const double y1 = plan.corridors.back().y1;
    plan.cross_corridors.push_back({-kCrossWidth, y0, 0, y1});
    plan.cross_corridors.push_back({options.corridor_length_m, y0, options.corridor_length_m + kCrossWidth, y1});
  }
  return plan;
}

}  // namespace mapweld::rendered
