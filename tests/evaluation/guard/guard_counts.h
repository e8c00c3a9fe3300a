// What the guard makes of a merge's verified edges, counted against the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/guard/alias_guard.h"
#include "tests/evaluation/guard/judged_merge.h"

namespace mapweld::evaluation {

struct EdgeCounts {
  std::size_t right = 0, wrong = 0, unknown = 0;
  std::size_t all() const { return right + wrong + unknown; }
  std::size_t not_wrong() const { return right + unknown; }
  void add(Truth truth);
  EdgeCounts& operator+=(const EdgeCounts& other);
};

// Images of either map.
struct Joined {
  std::size_t a = 0, b = 0;
  std::size_t both() const { return a + b; }
  Joined& operator+=(const Joined& other);
};

struct GuardCounts {
  std::uint64_t candidates = 0;
  EdgeCounts verified, confirmed;
  // Images (ignored ones included) with such an edge that is not known to be wrong.
  Joined joined_by_verified, joined;
  EdgeCounts inner_verified, inner_confirmed;
  // Clusters of edges whose ends are within two inner edges of each other in both maps, and none of which is right:
  // edges that are wrong and alone are clusters too.
  std::size_t wrong_joins_verified = 0, wrong_joins = 0;
  // Rendered: vertices of b that share 30 % of the view with one of a and have 50 features; those with a right verified
  // edge, and with a right confirmed one.
  std::size_t places = 0, places_verified = 0, places_confirmed = 0;
  double members_ms = 0, edges_ms = 0;  // constructing the guard, and judging all edges at once
  GuardCounts& operator+=(const GuardCounts& other);
};

struct GuardRun {
  std::vector<GuardVerdict> inter, inner;
  GuardCounts counts;
};
GuardRun run_guard(const JudgedMerge& judged, const GuardOptions& options);

// Images with one of the edges whose numbers are given.
Joined joined_by(const JudgedMerge& judged, const std::vector<std::size_t>& edges);

}  // namespace mapweld::evaluation
