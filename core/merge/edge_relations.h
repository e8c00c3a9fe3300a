// Which inter-map edges speak for each other and which against, and the clusters that they form.
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

// What cluster `of` hears from cluster `from` (itself included): the sum, over the pairs of an edge of one and an edge
// of the other that stand in the relation, of the product of their weights. Symmetric in the two.
struct ClusterBond {
  std::uint32_t of = 0;
  std::uint32_t from = 0;
  std::uint64_t support = 0;
  std::uint64_t contradiction = 0;
};

// What one edge hears from others: the sums of their weights. Its own counts as support.
struct EdgeBalance {
  std::uint64_t support = 0;
  std::uint64_t contradiction = 0;
};

// Two edges between the same two members support each other when their ends are at most `near_hops` apart in both
// maps; they contradict each other when that is so in one map while in the other the ends are out of reach of the
// balls. Both relations are symmetric. Sums of whole numbers: the order of the edges does not matter.
class EdgeRelations {
 public:
  // `member_of`: by merged vertex. All must outlive this object; the balls may be shared.
  EdgeRelations(std::span<const WeighedEdge> edges, std::span<const std::uint32_t> member_of, HopBalls& balls,
                int near_hops);

  // The cluster of each edge: edges that are at most `link_hops` <= near_hops apart in both maps are of one, and
  // through others. Numbered from 0 in the order of `edges`.
  std::vector<std::uint32_t> clusters(int link_hops);

  // All bonds, by (of, from). An edge supports itself.
  std::vector<ClusterBond> bonds(std::span<const std::uint32_t> cluster_of);

  // What each edge hears from those that are `heard`.
  std::vector<EdgeBalance> balances(const std::vector<bool>& heard);

 private:
  // Calls use(e, f, hops) for each edge e and each other edge f that is near it in one map, all calls for one e
  // together within a pass: with the greater of the distances between their ends when they support each other (in the
  // first of two passes), with kFar when they contradict each other.
  template <typename Use>
  void for_each_relation(const Use& use);
  template <typename Use>
  void relations_from(bool from_u, const Use& use);

  std::span<const WeighedEdge> edges_;
  std::span<const std::uint32_t> member_of_;
  HopBalls& balls_;
  int near_hops_;
  std::vector<std::uint32_t> offsets_, edges_at_;  // compressed sparse rows: the edges at each vertex
  static constexpr std::uint8_t kFar = 255;
  std::vector<std::uint8_t> hops_;  // scratch: from the vertex in hand; kFar outside its ball
};

}  // namespace mapweld
