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
void EdgeRelations::relations_from(bool from_u, const Use& use) {
  const auto here = [&](const WeighedEdge& e) { return from_u ? e.u : e.v; };
  const auto there = [&](const WeighedEdge& e) { return from_u ? e.v : e.u; };
  std::vector<std::uint32_t> order(edges_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t e) { return there(edges_[e]); });
  for (std::size_t first = 0; first < order.size();) {
    const VertexId end = there(edges_[order[first]]);
    const std::uint32_t member = member_of_[to_index(end)];
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
          if (f == e || member_of_[far_end] != member) continue;
          const std::uint8_t hops = hops_[far_end];
          if (hops == kFar) {
            use(e, f, kFar);
          } else if (from_u && hops <= near_hops_) {  // seen from either end; told once
            use(e, f, std::max(hops, neighbour.hops));
          }
        }
      }
    }
    for (const ReachedVertex& r : ball) hops_[r.vertex] = kFar;
  }
}

template <typename Use>
void EdgeRelations::for_each_relation(const Use& use) {
  relations_from(true, use);
  relations_from(false, use);
}

std::vector<std::uint32_t> EdgeRelations::clusters(int link_hops) {
  std::vector<std::uint32_t> parent(edges_.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t e) {
    while (parent[e] != e) e = parent[e] = parent[parent[e]];
    return e;
  };
  relations_from(true, [&](std::uint32_t e, std::uint32_t f, std::uint8_t hops) {
    if (hops > link_hops) return;
    const std::uint32_t a = root(e), b = root(f);
    parent[std::max(a, b)] = std::min(a, b);
  });
  std::vector<std::uint32_t> cluster(edges_.size());
  std::uint32_t count = 0;
  for (std::uint32_t e = 0; e < edges_.size(); ++e) cluster[e] = root(e) == e ? count++ : cluster[root(e)];
  return cluster;
}

std::vector<EdgeBalance> EdgeRelations::balances(const std::vector<bool>& heard) {
  std::vector<EdgeBalance> balances(edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) balances[e].support = edges_[e].weight;
  for_each_relation([&](std::uint32_t e, std::uint32_t f, std::uint8_t hops) {
    if (heard[f]) (hops == kFar ? balances[e].contradiction : balances[e].support) += edges_[f].weight;
  });
  return balances;
}

std::vector<ClusterBond> EdgeRelations::bonds(std::span<const std::uint32_t> cluster_of) {
  const std::uint32_t clusters = edges_.empty() ? 0 : *std::ranges::max_element(cluster_of) + 1;
  std::vector<ClusterBond> bonds;
  for (std::uint32_t e = 0; e < edges_.size(); ++e) {
    const std::uint64_t weight = edges_[e].weight;
    bonds.push_back({cluster_of[e], cluster_of[e], weight * weight, 0});
  }
  // What one edge hears, by cluster; put down when the next edge's turn comes.
  std::vector<std::uint64_t> support(clusters, 0), contradiction(clusters, 0);
  std::vector<std::uint32_t> heard;
  std::uint32_t listener = 0;
  const auto put_down = [&] {
    const std::uint64_t weight = edges_[listener].weight;
    for (const std::uint32_t c : heard) {
      bonds.push_back({cluster_of[listener], c, weight * support[c], weight * contradiction[c]});
      support[c] = contradiction[c] = 0;
    }
    heard.clear();
  };
  for_each_relation([&](std::uint32_t e, std::uint32_t f, std::uint8_t hops) {
    if (e != listener) {
      put_down();
      listener = e;
    }
    const std::uint32_t c = cluster_of[f];
    if (support[c] == 0 && contradiction[c] == 0) heard.push_back(c);
    (hops == kFar ? contradiction : support)[c] += edges_[f].weight;
  });
  if (!edges_.empty()) put_down();

  std::ranges::sort(bonds, {}, [](const ClusterBond& b) { return std::uint64_t{b.of} << 32 | b.from; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < bonds.size(); ++i) {
    if (kept > 0 && bonds[kept - 1].of == bonds[i].of && bonds[kept - 1].from == bonds[i].from) {
      bonds[kept - 1].support += bonds[i].support;
      bonds[kept - 1].contradiction += bonds[i].contradiction;
    } else {
      bonds[kept++] = bonds[i];
    }
  }
  bonds.resize(kept);
  return bonds;
}

}  // namespace mapweld
