// What the guard says while a merge goes on.
#pragma once

#include <cstddef>
#include <vector>

#include "tests/evaluation/guard/guard_counts.h"

namespace mapweld::evaluation {

struct PrefixCounts {
  std::size_t edges = 0, confirmed = 0;
  std::size_t joined = 0;  // images of both maps with a confirmed edge
  // With a confirmed one, and with a verified one, that is not known to be wrong.
  std::size_t joined_rightly = 0, joined_by_verified = 0;
  std::size_t wrong_confirmed = 0;
  bool as_fresh = true;  // the verdicts are those of a guard that has seen nothing before
};

// Where the rule of a merge at any time is kept and where not.
struct PrefixFigures {
  std::vector<PrefixCounts> prefixes;
  double least_share = 1;  // of joined_rightly in joined_by_verified, where that is not 0
  std::size_t below_70_percent = 0;
  double least_share_of_20 = 1;  // the same where verified edges join 20 images
  double largest_fall = 0;       // of joined below the most that there was, as a share of it
  double last_of_best = 1;
  std::size_t not_as_fresh = 0;
  std::size_t wrong_confirmed = 0;  // at the worst of them
};

// One guard that sees `edges` (judged's own, in some order) in so many equal parts. `compare`: each time also a fresh
// one.
PrefixFigures guard_prefixes(const JudgedMerge& judged, const std::vector<MergeEdge>& edges, std::size_t parts,
                             const GuardOptions& options, bool compare);

}  // namespace mapweld::evaluation
