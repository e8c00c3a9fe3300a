// The pieces that a building is furnished with, built from boxes and pictures of the catalogue.
#pragma once

#include <cstdint>

#include "tests/support/rendering/builder.h"

namespace mapweld::rendered {

enum class Piece : std::uint8_t {
  // on walls
  kPoster,
  kPicture,
  kNoticeBoard,
  kWhiteboard,
  kSign,
  kClock,
  kExtinguisher,
  kHoseBox,
  kSwitch,
  kSocket,
  kGrille,
  kSheets,     // a few sheets of paper, taped
  kWallShelf,  // with things on it
  kDuct,       // a cable duct from floor to ceiling
  kWindow,     // with a radiator below it
  // against walls
  kBookshelf,
  kStoreShelf,
  kCabinet,
  kDesk,  // with screen, papers, a chair
  kSofa,
  kPlant,
  kVending,
  kFridge,
  kKitchen,
  kCopier,
  kRack,
  kCartons,
  kBin,
  kBench,
  kPillar,
  // in the middle
  kTable,  // with chairs
  kLabBench,
};

struct PieceSize {
  double width_m;   // along the wall
  double depth_m;   // out of it
  double bottom_m;  // it occupies the wall from here ...
  double top_m;     // ... to here
};
PieceSize size_of(Piece piece);

// Builds the piece with its left end at the frame's origin, against the wall. `design` numbers a design of the
// catalogue: the same number, the same piece; `random` decides how it stands and what lies on it.
void build(Builder& builder, Piece piece, const WallFrame& frame, std::uint64_t design, Random& random);

}  // namespace mapweld::rendered
