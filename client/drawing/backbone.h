// A graph of many edges as a drawing shows it: the edges that hold it together, and the strongest ones of each vertex.
// (Which edges of a graph of images can be spared in a computation is another question: core/graph/sparsify.h.)
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace mapweld::drawing {

struct WeighedEdge {
  std::size_t u = 0;
  std::size_t v = 0;
  double weight = 0;
};

// By edge, whether it is kept: the edges of a maximum spanning forest, so that what hangs together still does, and for
// each vertex its `strongest` heaviest edges. Of equal weights the earlier edge counts as the heavier. Vertices count
// from 0 to `vertices` - 1.
std::vector<bool> backbone(std::size_t vertices, std::span<const WeighedEdge> edges, int strongest);

}  // namespace mapweld::drawing
