// A storey built on its floor plan: walls, floors, ceilings, lamps and doors, dressed and furnished.
#pragma once

#include <vector>

#include "tests/support/rendering/furnisher.h"

namespace mapweld::rendered {

struct Storey {
  Scene scene;
  std::vector<int>
      room_cells;  // cell of each room of the plan, -1 if closed; corridors are cells 0, 1, ..., then cross
  std::vector<PosterPlace> posters;
};

Storey build_storey(const FloorPlan& plan, const StoreyOptions& options, Catalogue& catalogue, Deck& deck);

}  // namespace mapweld::rendered
