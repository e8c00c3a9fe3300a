// Which vertices lie within a few hops of one another in the members' own maps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/types.h"

namespace mapweld {

// A vertex within reach of another, and over how many hops.
struct ReachedVertex {
  std::uint32_t vertex = 0;  // merged number
  std::uint8_t hops = 0;
};

// Hops go over inner edges and over the step from a vertex to the next one that its member took in: a robot sends its
// images as it drives. Immutable after construction apart from the cache of balls: one thread.
class HopBalls {
 public:
  HopBalls(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges, std::uint8_t radius);

  // Every vertex within `radius` hops of `centre`, itself included, nearest first. Found once, then remembered; valid
  // as long as this object.
  std::span<const ReachedVertex> around(VertexId centre);

  std::uint32_t vertices() const { return static_cast<std::uint32_t>(offsets_.size() - 1); }

 private:
  std::uint8_t radius_;
  std::vector<std::uint32_t> offsets_, neighbours_;  // compressed sparse rows
  std::vector<std::vector<ReachedVertex>> balls_;    // empty: not found yet
  std::vector<std::uint32_t> visited_;               // scratch: stamp of the last search that came by
  std::uint32_t stamp_ = 0;
};

}  // namespace mapweld
