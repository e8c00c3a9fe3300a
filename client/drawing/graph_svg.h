// The graph of a map as a figure: the paper's figure 4.
#pragma once

#include <string>

#include "client/contract/graph.h"

namespace mapweld::drawing {

struct GraphSvgOptions {
  bool unconfirmed = false;  // draw the edges that are only verified too, grey and dashed below the others
  // A graph of more confirmed edges a vertex is drawn thinned out: the edges that hold it together, and the strongest
  // so many of each vertex, of those within maps and of those between them.
  double dense = 8;
  int strongest_inner = 2;
  int strongest_inter = 1;
};

// An SVG document: a circle a vertex in the colour of the map it comes from (contract::Vertex::map), a thin grey line
// an edge within a map, a red line an edge between maps, a legend with counts of all, drawn or not. Vertices are placed
// by the confirmed edges. Hovering over a vertex names it. For graphs of some thousands of vertices: 1,958 with 12,793
// edges take half a second. Throws what layout_graph throws.
std::string graph_svg(const std::string& name, const contract::Graph& graph, const GraphSvgOptions& options = {});

}  // namespace mapweld::drawing
