// The bare shell of a cell: floor, ceiling, lamps, and walls with openings and doors.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/rendering/builder.h"

namespace mapweld::rendered {

// An opening in a wall, from the floor up.
struct Opening {
  Span s;
  double height_m = 0;
  int to_cell = -1;
  double depth_m = 0;  // half the thickness of the wall; 0: the wall is a line on the plan
};

// One of the four walls of a rectangular cell, with what is taken of it.
struct Wall {
  WallFrame frame;
  double length_m = 0;
  std::vector<Opening> openings;
  struct Taken {
    Span s;
    Span z;
  };
  std::vector<Taken> taken;

  bool is_free(const Span& s, const Span& z) const;
};

enum class Side { kSouth, kEast, kNorth, kWest };

Wall wall_of(const Area& area, Side side);
// Metres along the wall of a point with this x (north, south) or y (east, west).
double along_wall(const Area& area, Side side, double coordinate);

struct ShellDesigns {
  std::uint64_t wall = 0;
  std::uint64_t floor = 0;
  std::uint64_t paint = 0;  // of frames
  std::uint64_t ceiling = 0;
  double offset = 0;  // 0..1: where on the walls, floor and ceiling their materials begin
};

// Floor and ceiling.
void build_floor_and_ceiling(Builder& builder, const ShellDesigns& designs);
// Wall surfaces, and portals with their jambs.
void build_wall(Builder& builder, const Wall& wall, const ShellDesigns& designs);
// Lamps `pitch_m` apart, in rows along the longer side.
void build_lamps(Builder& builder, double pitch_m, int rows);
// Smoke detectors, loudspeakers, sprinklers and vents, about one for every 2 square metres.
void build_ceiling_things(Builder& builder, std::uint64_t seed);
// The frame round a door; `leaf`: the closed door as well.
void build_door(Builder& builder, const WallFrame& frame, double middle_s, double width, double height,
                const ShellDesigns& designs, bool leaf, std::uint64_t door);

}  // namespace mapweld::rendered
