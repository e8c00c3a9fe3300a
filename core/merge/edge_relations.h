// Which inter-map edges speak for each other and which against.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/hop_balls.h"
#include "core/types.h"

namespace mapweld {

// An edge by its ends and what its word weighs.
struct WeighedEdge {
  VertexId u{};
  VertexId v{};
  std::uint32_t weight = 0;
};

struct EdgeBalance {
  std::uint64_t support = 0;        // of the edges that support it, its own weight included
  std::uint64_t contradiction = 0;  // of the edges that contradict it
};

// Two edges between the same two members support each other when their ends are at most `near_hops` apart in both
// maps; they contradict each other when that is so in one map while in the other they are more than `far_hops` apart.
// Both relations are symmetric. Sums of whole numbers: the order of the edges does not matter.
class EdgeRelations {
 public:
  // `member_of`: by merged vertex. The balls reach far_hops. All three must outlive this object.
  EdgeRelations(std::span<const WeighedEdge> edges, std::span<const std::uint32_t> member_of, HopBalls& balls,
                int near_hops);

  // Of every edge, all edges counted.
  std::vector<EdgeBalance> balances();
  // Takes the words of the edges `dropped` out of `balances`.
  void withdraw(std::span<const std::uint32_t> dropped, std::vector<EdgeBalance>& balances);

 private:
  // Calls use(e, f, supports) for each of `which` and each other edge f that supports or contradicts it.
  template <typename Use>
  void for_each_relation(std::span<const std::uint32_t> which, const Use& use);
  template <typename Use>
  void relations_from(bool from_u, std::span<const std::uint32_t> which, const Use& use);

  std::span<const WeighedEdge> edges_;
  std::span<const std::uint32_t> member_of_;
  HopBalls& balls_;
  int near_hops_;
  std::vector<std::uint32_t> offsets_, edges_at_;  // compressed sparse rows: the edges at each vertex
  static constexpr std::uint8_t kFar = 255;
  std::vector<std::uint8_t> hops_;  // scratch: from the vertex in hand; kFar outside its ball
};

}  // namespace mapweld
