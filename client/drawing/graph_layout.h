// Where the vertices of a graph stand in a picture: from the graph alone, no coordinates of the world.
#pragma once

#include <compare>
#include <cstddef>
#include <span>
#include <vector>

namespace mapweld::drawing {

struct Position {
  double x = 0;
  double y = 0;
  friend bool operator==(const Position&, const Position&) = default;
};

// An undirected edge. An edge of length 2 or more pulls as if it had so many links: its ends come to stand further
// apart.
struct LayoutEdge {
  std::size_t u = 0;
  std::size_t v = 0;
  friend auto operator<=>(const LayoutEdge&, const LayoutEdge&) = default;
};

// Positions, the unit being the median length of an edge, in a box from (0, 0) to (width, height).
struct Layout {
  std::vector<Position> positions;  // one a vertex
  double width = 0;
  double height = 0;
};

// Places `vertices` vertices joined by `edges` (loops and repetitions do no harm). Every
// component is placed by Graphviz's sfdp (a multilevel spring-electrical model: Hu 2005, "Efficient, high-quality
// force-directed graph drawing") and turned so that its long side lies; the components are packed, the largest first at
// the top left, vertices without any edge in rows at the bottom. The same graph is always placed alike.
// Not thread-safe (Graphviz is not), and seeds rand(). Throws std::runtime_error when Graphviz's layout plugin cannot
// be loaded, std::invalid_argument for an edge out of range.
Layout layout_graph(std::size_t vertices, std::span<const LayoutEdge> edges);

}  // namespace mapweld::drawing
