// A verified edge as the guard takes it: which images, and which of their features agree.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/types.h"

namespace mapweld {

// Of one map (own numbers) or of the members of a merge (merged numbers); u < v.
struct VerifiedEdge {
  VertexId u{};
  VertexId v{};
  // Indices into the appearances of u and of v, as in Verification; their number is the edge's weight.
  std::vector<std::pair<std::uint16_t, std::uint16_t>> inlier_matches;
  friend bool operator==(const VerifiedEdge&, const VerifiedEdge&) = default;
};

}  // namespace mapweld
