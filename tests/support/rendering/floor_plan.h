// Where the walls and doors of a storey are.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/rendering/scene.h"

namespace mapweld::rendered {

struct FloorPlanOptions {
  int corridors = 2;  // parallel, east-west; two or more are joined at both ends into loops
  double corridor_length_m = 18;
  double open_rooms = 0.6;      // share of the rooms whose door is open
  bool same_corridors = false;  // all corridors alike: the same doors at the same places
  std::uint64_t seed = 1;
};

enum class RoomKind { kOffice, kMeeting, kKitchen, kLibrary, kLaboratory, kStore };

struct Room {
  Area area;  // inside the walls
  int corridor = 0;
  bool north = false;   // on which side of its corridor
  double door_x_m = 0;  // middle of its door
  bool open = false;    // closed rooms have a door and no inside
  RoomKind kind = RoomKind::kOffice;
  int number = 0;  // counts within its corridor
  std::uint64_t seed = 0;
  Area lookout() const;  // where a robot turns round
};

struct FloorPlan {
  double storey_height_m = 2.8;
  double wall_m = 0.16;  // thickness of the walls between corridors and rooms
  double door_width_m = 0.98;
  double door_height_m = 2.08;
  std::vector<Area> corridors;        // from south to north
  std::vector<Area> cross_corridors;  // none, or west and east
  std::vector<Room> rooms;            // by corridor, then side, then x
};

FloorPlan make_floor_plan(const FloorPlanOptions& options);

}  // namespace mapweld::rendered
