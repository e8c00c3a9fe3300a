// Algorithms 1 and 2 of the paper, and brute force, written down once more: slow, with maps and sets only, and nothing
// in common with core/merge but its input. The oracle of the order of everything that a merge does.
#pragma once

#include <cstdint>
#include <vector>

#include "core/merge/merge_input.h"

namespace mapweld::test {

struct OracleVerdict {
  VertexId source{};
  VertexId target{};
  std::uint32_t votes = 0;  // final
  bool accepted = false;
  friend bool operator==(const OracleVerdict&, const OracleVerdict&) = default;
};

struct OracleRun {
  std::vector<OracleVerdict> verdicts;  // in order of verification
  std::vector<WordId> words;            // QuickConnect: in the order in which they were taken
  std::size_t explored = 0;             // QuickConnect: how many verdicts were reached in exploration
};

OracleRun quick_connect_by_the_paper(const MergeInput& input);
OracleRun brute_force_by_the_paper(const MergeInput& input);

}  // namespace mapweld::test
