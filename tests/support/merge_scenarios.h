// Situations in which two maps are merged and images may deceive, rendered.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/rendered_merge.h"

namespace mapweld::rendered {

struct MergeScenario {
  std::string_view name;
  std::string_view what;  // one line
  // False: a limit. Nothing, or too little, tells the wrong place from a right one (docs/alias-guard.md, "Limits").
  bool told_apart = true;
};

// In the order of docs/alias-guard.md.
const std::vector<MergeScenario>& merge_scenarios();

// Some 60 to 150 images a robot; another seed, another building and other drives. Throws std::invalid_argument for a
// name that is not in the list.
MadeMerge make_scenario(std::string_view name, std::uint64_t seed, const Vocabulary& vocabulary, int threads);

}  // namespace mapweld::rendered
