// A storey built on its floor plan: walls, floors, ceilings, lamps and doors, dressed and furnished.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "tests/support/rendering/builder.h"
#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {

// Deals the catalogue's posters, pictures, boards and books to a building: none twice until all have been used, but for
// as many posters as are asked for.
class Deck {
 public:
  Deck(std::uint64_t seed, int designs, int posters_in_two_places);

  // The design for a place; places with one key get one design (that is how corridors look alike).
  std::uint64_t deal(Design kind, std::uint64_t key);

 private:
  std::uint64_t seed_;
  int designs_;
  int to_repeat_;
  std::map<Design, std::vector<std::uint64_t>> cards_;
  std::map<Design, std::size_t> dealt_;
  std::map<std::pair<Design, std::uint64_t>, std::uint64_t> places_;
};

struct StoreyOptions {
  std::uint64_t seed = 1;
  int storey = 0;
  double look_alike_corridors = 0;  // probability that a place of a corridor is dressed as in the first corridor
  double look_alike_storeys = 0;    // likewise, as on the ground floor
};

// Where a poster hangs.
struct PosterPlace {
  std::uint64_t design = 0;
  Vec3 position;  // its middle
  Vec3 facing;
};

struct Storey {
  Scene scene;
  std::vector<int>
      room_cells;  // cell of each room of the plan, -1 if closed; corridors are cells 0, 1, ..., then cross
  std::vector<PosterPlace> posters;
};

Storey build_storey(const FloorPlan& plan, const StoreyOptions& options, Catalogue& catalogue, Deck& deck);

}  // namespace mapweld::rendered
