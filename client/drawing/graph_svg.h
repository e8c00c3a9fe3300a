// The graph of a map as a figure: the paper's figure 4.
#pragma once

#include <string>

#include "client/contract/graph.h"

namespace mapweld::drawing {

// An SVG document: a circle a vertex in the colour of the map it comes from (contract::Vertex::map), a thin grey line
// an edge within a map, a red line an edge between maps (dashed when it is not confirmed), a legend with counts.
// Hovering over a vertex names it. Draws graphs of some thousands of vertices; takes about 2 s for 2,000 (see
// layout_graph, whose errors it throws).
std::string graph_svg(const std::string& name, const contract::Graph& graph);

}  // namespace mapweld::drawing
