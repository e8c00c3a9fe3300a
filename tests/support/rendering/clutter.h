// What people move about: chairs, papers, books, boxes. Wear moves, swaps and takes it; what comes after it stays as it
// is.
#pragma once

#include "tests/support/rendering/builder.h"
#include "tests/support/rendering/pieces.h"

namespace mapweld::rendered {

// An office chair whose seat is over (s, t).
void chair(Builder& builder, const WallFrame& frame, double s, double t, double angle_deg, std::uint64_t design);
// Mugs, books and papers on a board at height z.
void things_on_top(Builder& builder, const WallFrame& frame, const Span& s, const Span& t, double z, int count,
                   Random& random);
// Books and boxes along a shelf on a wall.
void things_on_shelf(Builder& builder, const WallFrame& frame, const PieceSize& size, Random& random);
// Piles of cartons.
void cartons(Builder& builder, const WallFrame& frame, const PieceSize& size, Random& random);

}  // namespace mapweld::rendered
