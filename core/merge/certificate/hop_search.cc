#include "core/merge/certificate/hop_search.h"

#include <algorithm>
#include <limits>

#include "core/geometry/portable_math.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kMostHops = 4;

Nearness of_hops(std::uint32_t hops) {
  return static_cast<Nearness>(std::clamp<std::uint32_t>(hops, 2, kMostHops + 1) - 2);
}

Relation apart(std::size_t vertices, std::size_t others) {
  return {kOtherComponent, portable_log2(static_cast<double>(std::min(vertices, others)))};
}

}  // namespace

HopSearch::HopSearch(const AppearanceGraph& graph)
    : graph_(graph), components_(connected_components(graph)), hops_(graph.vertices()), search_(graph.vertices(), 0) {}

void HopSearch::search(VertexId from, VertexId avoided, std::uint32_t most_hops) {
  ++number_;
  from_ = from;
  search_[to_index(from)] = number_;
  hops_[to_index(from)] = 0;
  queue_ = {from};
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::uint32_t next = hops_[to_index(queue_[i])] + 1;
    if (next > most_hops) return;
    for (const Neighbour& n : graph_.neighbours(queue_[i])) {
      if (is_reached(n.vertex) || (i == 0 && n.vertex == avoided)) continue;
      search_[to_index(n.vertex)] = number_;
      hops_[to_index(n.vertex)] = next;
      if (n.vertex == avoided) return;
      queue_.push_back(n.vertex);
    }
  }
}

void HopSearch::begin(VertexId from) { search(from, from, kMostHops); }

Relation HopSearch::to(VertexId v) const {
  if (is_reached(v)) return {of_hops(hops_[to_index(v)]), 0};
  if (components_.component_of[to_index(from_)] == components_.component_of[to_index(v)]) return {kSameComponent, 0};
  return apart(size_of(from_), size_of(v));
}

Relation HopSearch::without_edge(VertexId u, VertexId v) {
  search(u, v, std::numeric_limits<std::uint32_t>::max());
  if (is_reached(v)) return {of_hops(hops_[to_index(v)]), 0};
  return apart(queue_.size(), size_of(u) - queue_.size());
}

}  // namespace mapweld
