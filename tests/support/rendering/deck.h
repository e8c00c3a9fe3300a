// Which designs of the catalogue a building gets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "tests/support/rendering/catalogue.h"

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

}  // namespace mapweld::rendered
