// The undirected weighted graph G = (V, E) of an appearance-based map (paper, section III).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace mapweld {

struct Neighbour {
  VertexId vertex{};
  std::uint32_t weight = 0;
  friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

// Vertices are 0 .. vertices()-1. Simple graph: no loops, an edge at most once (the second insert is refused).
// One writer or many readers.
class AppearanceGraph {
 public:
  explicit AppearanceGraph(std::uint32_t vertices = 0);
  AppearanceGraph(std::uint32_t vertices, std::span<const Edge> edges);

  VertexId add_vertex();
  // False (and nothing changed) for an edge that exists already. Throws std::invalid_argument for a loop or an
  // endpoint out of range.
  bool add_edge(VertexId u, VertexId v, std::uint32_t weight);

  std::uint32_t vertices() const { return static_cast<std::uint32_t>(neighbours_.size()); }
  std::uint64_t edges() const { return edges_; }
  std::uint32_t degree(VertexId v) const;
  std::span<const Neighbour> neighbours(VertexId v) const;  // in order of insertion
  bool has_edge(VertexId u, VertexId v) const;
  std::vector<Edge> edge_list() const;  // u < v, ascending

  friend bool operator==(const AppearanceGraph&, const AppearanceGraph&) = default;

 private:
  std::vector<std::vector<Neighbour>> neighbours_;
  std::uint64_t edges_ = 0;
};

}  // namespace mapweld
