#include "core/graph/appearance_graph.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace mapweld {

AppearanceGraph::AppearanceGraph(std::uint32_t vertices) : neighbours_(vertices) {}

AppearanceGraph::AppearanceGraph(std::uint32_t vertices, std::span<const Edge> edges) : neighbours_(vertices) {
  for (const Edge& edge : edges) add_edge(edge.u, edge.v, edge.weight);
}

VertexId AppearanceGraph::add_vertex() {
  neighbours_.emplace_back();
  return VertexId{vertices() - 1};
}

bool AppearanceGraph::add_edge(VertexId u, VertexId v, std::uint32_t weight) {
  if (u == v) throw std::invalid_argument("an edge joins two distinct vertices, not " + std::to_string(to_index(u)));
  if (to_index(u) >= vertices() || to_index(v) >= vertices()) {
    throw std::invalid_argument("edge (" + std::to_string(to_index(u)) + ", " + std::to_string(to_index(v)) +
                                ") in a graph of " + std::to_string(vertices()) + " vertices");
  }
  if (has_edge(u, v)) return false;
  neighbours_[to_index(u)].push_back({v, weight});
  neighbours_[to_index(v)].push_back({u, weight});
  ++edges_;
  return true;
}

std::uint32_t AppearanceGraph::degree(VertexId v) const {
  return static_cast<std::uint32_t>(neighbours_.at(to_index(v)).size());
}

std::span<const Neighbour> AppearanceGraph::neighbours(VertexId v) const { return neighbours_.at(to_index(v)); }

bool AppearanceGraph::has_edge(VertexId u, VertexId v) const {
  if (to_index(u) >= vertices() || to_index(v) >= vertices()) return false;
  const bool u_is_smaller = neighbours_[to_index(u)].size() <= neighbours_[to_index(v)].size();
  const VertexId from = u_is_smaller ? u : v;
  const VertexId to = u_is_smaller ? v : u;
  return std::ranges::any_of(neighbours_[to_index(from)], [to](const Neighbour& n) { return n.vertex == to; });
}

std::vector<Edge> AppearanceGraph::edge_list() const {
  std::vector<Edge> edges;
  edges.reserve(edges_);
  for (std::uint32_t u = 0; u < vertices(); ++u) {
    for (const Neighbour& n : neighbours_[u]) {
      if (u < to_index(n.vertex)) edges.push_back({VertexId{u}, n.vertex, n.weight});
    }
  }
  std::ranges::sort(edges);
  return edges;
}

}  // namespace mapweld
