// Routes through an appearance graph, for navigation from image to image.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/types.h"

namespace mapweld {

struct Route {
  std::vector<VertexId> vertices;  // from .. to, both included
  std::uint32_t min_weight = 0;    // of its weakest edge; 0 for a route of one vertex
  friend bool operator==(const Route&, const Route&) = default;
};

// The widest path, the one whose weakest edge is strongest; of several the one with the fewest edges, then the one that
// prefers lower vertices step by step from `to` backwards. nullopt when there is none. The image-based navigation of
// the paper needs a number of common features between consecutive images, so a route is as good as its weakest edge.
// O(E log V). Throws std::invalid_argument for an endpoint out of range.
std::optional<Route> widest_route(const AppearanceGraph& graph, VertexId from, VertexId to);

}  // namespace mapweld
