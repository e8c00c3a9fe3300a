// Vertex degrees. lambda_2 <= n / (n - 1) * minimum degree (Fiedler 1973): the minimum degree is a ceiling.
#pragma once

#include <cstdint>
#include <vector>

#include "core/graph/appearance_graph.h"

namespace mapweld {

std::vector<std::uint32_t> degrees(const AppearanceGraph& graph);  // by vertex

// 0 for a graph without vertices.
std::uint32_t min_degree(const AppearanceGraph& graph);

}  // namespace mapweld
