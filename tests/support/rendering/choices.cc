#include "tests/support/rendering/choices.h"

#include <array>
#include <cstddef>

namespace mapweld::rendered {
namespace {

struct Choice {
  Piece piece;
  int weight;
};
constexpr std::array<Choice, 19> kCorridorPieces{{{Piece::kPoster, 30},
                                                  {Piece::kSheets, 10},
                                                  {Piece::kWallShelf, 4},
                                                  {Piece::kDuct, 5},
                                                  {Piece::kPicture, 12},
                                                  {Piece::kNoticeBoard, 20},
                                                  {Piece::kPlant, 9},
                                                  {Piece::kCabinet, 7},
                                                  {Piece::kBookshelf, 9},
                                                  {Piece::kBench, 5},
                                                  {Piece::kExtinguisher, 6},
                                                  {Piece::kHoseBox, 4},
                                                  {Piece::kSign, 4},
                                                  {Piece::kPillar, 4},
                                                  {Piece::kBin, 4},
                                                  {Piece::kCartons, 5},
                                                  {Piece::kWhiteboard, 2},
                                                  {Piece::kClock, 2},
                                                  {Piece::kStoreShelf, 4}}};

}  // namespace

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

std::vector<Piece> choose_room_pieces(RoomKind kind, Random& random) {
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
  const int small = random.between(14, 20);
  for (int i = 0; i < small; ++i) {
    constexpr std::array<Piece, 8> kSmall{Piece::kSheets, Piece::kWallShelf, Piece::kSocket, Piece::kSheets,
                                          Piece::kSign,   Piece::kPicture,   Piece::kPoster, Piece::kNoticeBoard};
    pieces.push_back(kSmall[static_cast<std::size_t>(random.below(8))]);
  }
  return pieces;
}
Piece choose_small_corridor_piece(Random& random) {
  constexpr std::array<Piece, 6> kBetween{Piece::kSheets, Piece::kWallShelf, Piece::kPicture,
                                          Piece::kSheets, Piece::kSign,      Piece::kSheets};
  return kBetween[static_cast<std::size_t>(random.below(6))];
}

}  // namespace mapweld::rendered
