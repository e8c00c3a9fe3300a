// Where the vertices of a graph stand in a picture: from the graph alone, no coordinates of the world.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace mapweld::drawing {

struct Position {
  double x = 0;
  double y = 0;
  friend bool operator==(const Position&, const Position&) = default;
};

// Positions, the unit being the median length of an edge, in a box from (0, 0) to (width, height).
struct Layout {
  std::vector<Position> positions;  // one a vertex
  double width = 0;
  double height = 0;
};

// Places `vertices` vertices joined by `edges` (pairs of vertex numbers; loops and repetitions do no harm). Every
// component is placed by Graphviz's sfdp (a multilevel spring-electrical model: Hu 2005, "Efficient, high-quality
// force-directed graph drawing") and turned so that its long side lies; the largest stands on top, the others in rows
// below it, vertices without any edge in rows at the bottom. The same graph is always placed alike.
// Not thread-safe (Graphviz is not). Throws std::runtime_error when Graphviz's layout plugin cannot be loaded,
// std::invalid_argument for an edge out of range.
Layout layout_graph(std::size_t vertices, std::span<const std::pair<std::size_t, std::size_t>> edges);

}  // namespace mapweld::drawing
