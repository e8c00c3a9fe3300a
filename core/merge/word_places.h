// Where in its map a word occurs: what is everywhere says little.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/types.h"

namespace mapweld {

// The postings of every word, all members together, by merged vertex. Immutable.
class WordPlaces {
 public:
  // Reads every appearance vector once.
  WordPlaces(const AppearanceSource& appearances, const std::vector<MergeMember>& members);

  // The vertices with the word, by member and then ascending within it; empty for a word that nobody has.
  std::span<const std::uint32_t> vertices_with(WordId word) const;

 private:
  std::vector<std::uint32_t> offsets_;  // by word, one more at the end
  std::vector<std::uint32_t> vertices_;
};

}  // namespace mapweld
