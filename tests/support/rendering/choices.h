// What belongs into which kind of place.
#pragma once

#include <vector>

#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/pieces.h"
#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {

// A piece for a free place at a corridor's wall.
Piece choose_corridor_piece(Random& random);
// A smaller one, above what stands there or between what hangs there.
Piece choose_small_corridor_piece(Random& random);
// The pieces of a room, those that name its kind first; there may be more than fit.
std::vector<Piece> choose_room_pieces(RoomKind kind, Random& random);

}  // namespace mapweld::rendered
