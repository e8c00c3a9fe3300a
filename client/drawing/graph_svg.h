// The graph of a map as a figure: the paper's figure 4.
#pragma once

#include <string>

#include "client/contract/graph.h"

namespace mapweld::drawing {

// An SVG document: a circle a vertex in the colour of the map it comes from (contract::Vertex::map), a thin grey line
// an edge within a map, a red line an edge between maps (dashed when it is not confirmed), a legend with counts.
// Hovering over a vertex names it. For graphs of some thousands of vertices: 1,958 with 12,793 edges take half a
// second. Throws what layout_graph throws.
std::string graph_svg(const std::string& name, const contract::Graph& graph);

}  // namespace mapweld::drawing
