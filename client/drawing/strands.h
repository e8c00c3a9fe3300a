// Merged maps that run along the same corridors come to lie on one line in a layout, and what joins them is hidden.
// This draws them side by side, as strands with rungs between them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "client/drawing/graph_layout.h"

namespace mapweld::drawing {

struct StrandOptions {
  double distance = 2.2;  // between neighbouring strands, in the layout's unit
  double reach = 8;       // how far the direction of a strand is judged from, likewise
};

// Moves every vertex sideways to the direction in which the vertices around it run: by where its group stands among the
// groups nearby, less where the surroundings have no direction or no other group. `group` is one number a vertex.
// The sides are chosen alike along edges (propagated over a maximum spanning tree, as Hoppe et al. 1992 orient
// normals), so that strands do not cross without need. Deterministic.
void separate_strands(Layout& layout, std::span<const std::size_t> group, std::span<const LayoutEdge> edges,
                      const StrandOptions& options = {});

}  // namespace mapweld::drawing
