#include "core/merge/edge_relations.h"

#include <algorithm>
#include <numeric>

namespace mapweld {

EdgeRelations::EdgeRelations(std::span<const WeighedEdge> edges, std::span<const std::uint32_t> member_of,
                             HopBalls& balls, int near_hops)
    : edges_(edges), member_of_(member_of), balls_(balls), near_hops_(near_hops) {
  offsets_.assign(balls.vertices() + 1, 0);
  for (const WeighedEdge& e : edges) {
    ++offsets_[to_index(e.u) + 1];
    ++offsets_[to_index(e.v) + 1];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  edges_at_.resize(offsets_.back());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    edges_at_[next[to_index(edges[e].u)]++] = e;
    edges_at_[next[to_index(edges[e].v)]++] = e;
  }
  hops_.assign(balls.vertices(), kFar);
}

// The edges f that have an end near the u (or v) of e. Their other ends are looked up in the ball around e's other end,
// which is laid out once for all edges that end there.
template <typename Use>
void EdgeRelations::relations_from(bool from_u, std::span<const std::uint32_t> which, const Use& use) {
  const auto here = [&](const WeighedEdge& e) { return from_u ? e.u : e.v; };
  const auto there = [&](const WeighedEdge& e) { return from_u ? e.v : e.u; };
  std::vector<std::uint32_t> order(which.begin(), which.end());
  std::ranges::sort(order, {}, [&](std::uint32_t e) { return there(edges_[e]); });
  for (std::size_t first = 0; first < order.size();) {
    const VertexId end = there(edges_[order[first]]);
    const auto ball = balls_.around(end);
    for (const ReachedVertex& r : ball) hops_[r.vertex] = r.hops;
    for (; first < order.size() && there(edges_[order[first]]) == end; ++first) {
      const std::uint32_t e = order[first];
      for (const ReachedVertex& neighbour : balls_.around(here(edges_[e]))) {
        if (neighbour.hops > near_hops_) break;
        for (std::uint32_t k = offsets_[neighbour.vertex]; k < offsets_[neighbour.vertex + 1]; ++k) {
          const std::uint32_t f = edges_at_[k];
          const WeighedEdge& other = edges_[f];
          const std::uint32_t far_end = to_index(other.u) == neighbour.vertex ? to_index(other.v) : to_index(other.u);
          if (f == e || member_of_[far_end] != member_of_[to_index(end)]) continue;
          if (hops_[far_end] == kFar) {
            use(e, f, false);
          } else if (from_u && hops_[far_end] <= near_hops_) {  // seen from either end; counted once
            use(e, f, true);
          }
        }
      }
    }
    for (const ReachedVertex& r : ball) hops_[r.vertex] = kFar;
  }
}

template <typename Use>
void EdgeRelations::for_each_relation(std::span<const std::uint32_t> which, const Use& use) {
  relations_from(true, which, use);
  relations_from(false, which, use);
}

std::vector<EdgeBalance> EdgeRelations::balances() {
  std::vector<EdgeBalance> balances(edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) balances[e].support = edges_[e].weight;
  std::vector<std::uint32_t> all(edges_.size());
  std::iota(all.begin(), all.end(), 0u);
  for_each_relation(all, [&](std::uint32_t e, std::uint32_t f, bool supports) {
    (supports ? balances[e].support : balances[e].contradiction) += edges_[f].weight;
  });
  return balances;
}

void EdgeRelations::withdraw(std::span<const std::uint32_t> dropped, std::vector<EdgeBalance>& balances) {
  for_each_relation(dropped, [&](std::uint32_t e, std::uint32_t f, bool supports) {
    (supports ? balances[f].support : balances[f].contradiction) -= edges_[e].weight;
  });
}

}  // namespace mapweld
