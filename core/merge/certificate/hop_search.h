// How near each other two images are in a graph, by hops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/graph/components.h"

namespace mapweld {

// Two hops or fewer: a common neighbour. kSameComponent: more than four.
enum Nearness : std::uint8_t { kTwoHops, kThreeHops, kFourHops, kSameComponent, kOtherComponent, kNearnesses };

struct Relation {
  Nearness nearness = kOtherComponent;
  double smaller_component_log2 = 0;  // kOtherComponent: of the vertices of the smaller of the two; otherwise 0
};

// Breadth-first searches over one graph, which must outlive this and stay as it is. One thread.
class HopSearch {
 public:
  explicit HopSearch(const AppearanceGraph& graph);

  // From one image; to() then tells of all others, until the next search. Costs what lies within four hops.
  void begin(VertexId from);
  Relation to(VertexId v) const;
  // Between the ends of an edge of the graph, were it not there. Costs what lies nearer than that, or the component.
  Relation without_edge(VertexId u, VertexId v);

 private:
  // Reaches all that lies within `most_hops` of `from`, but not by the edge to `avoided`; stops when `avoided` is
  // reached. Avoiding `from` itself avoids nothing.
  void search(VertexId from, VertexId avoided, std::uint32_t most_hops);
  bool is_reached(VertexId v) const { return search_[to_index(v)] == number_; }
  std::size_t size_of(VertexId v) const { return components_.sizes[components_.component_of[to_index(v)]]; }

  const AppearanceGraph& graph_;
  Components components_;
  std::vector<std::uint32_t> hops_, search_;  // by vertex: hops in the search that reached it last, and its number
  std::uint32_t number_ = 0;
  VertexId from_{};
  std::vector<VertexId> queue_;
};

}  // namespace mapweld
