// Finds room for pieces along walls and in the middle of rooms.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/rendering/builder.h"
#include "tests/support/rendering/deck.h"
#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/pieces.h"
#include "tests/support/rendering/repeatable.h"
#include "tests/support/rendering/shell.h"

namespace mapweld::rendered {

struct StoreyOptions {
  std::uint64_t seed = 1;
  int storey = 0;
  double look_alike_corridors = 0;  // probability that a place of a corridor is dressed as in the first corridor
  double look_alike_storeys = 0;    // likewise, as on the ground floor
  double worn_copies = 0;           // how much it has aged on its own
};

// Where a poster hangs.
struct PosterPlace {
  std::uint64_t design = 0;
  Vec3 position;  // its middle
  Vec3 facing;
};

class Furnisher {
 public:
  Furnisher(const StoreyOptions& options, Catalogue& catalogue, Deck& deck)
      : options_(options), catalogue_(catalogue), deck_(deck) {}

  // Builds the piece with its left end at s, if the place is free. It will not stand in `lane`, if there is one. `key`
  // names the place to the deck.
  bool place(Builder& builder, Wall& wall, Piece piece, double s, std::uint64_t key, Random& random,
             const Area* lane = nullptr);
  // Builds the piece somewhere in the room, out of the lane, if there is space.
  void place_in_the_middle(Builder& builder, const Room& room, Piece piece, const Area& lane, Random& random);
  // Dresses one wall of a corridor. Corridors from kUnlike on look like no other.
  void dress(Builder& builder, Wall& wall, int corridor, int side);

  // The seed of a place in a corridor: its own, or that of the same place in the first corridor, or on the ground
  // floor.
  std::uint64_t place_seed(int corridor, int side, int place) const;

  // The posters hung so far.
  const std::vector<PosterPlace>& posters() const { return posters_; }

  static constexpr int kUnlike = 1000;

 private:
  std::uint64_t design_of(Piece piece, std::uint64_t key, Random& random, Wear& wear);

  StoreyOptions options_;
  Catalogue& catalogue_;
  Deck& deck_;
  std::vector<PosterPlace> posters_;
};

}  // namespace mapweld::rendered
