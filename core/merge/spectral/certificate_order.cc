#include "core/merge/spectral/certificate_order.h"

#include <algorithm>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/component_edges.h"
#include "core/graph/near_fiedler.h"

namespace mapweld {

CertificateOrder certificate_order(const AppearanceGraph& graph, std::span<const std::pair<VertexId, VertexId>> open,
                                   std::size_t count) {
  CertificateOrder order;
  if (graph.vertices() == 0 || open.empty()) return order;
  const LargestComponentConnectivity largest = largest_component_connectivity(graph);
  ComponentEdges component = component_edges(graph, largest.vertices);
  struct Within {
    std::uint32_t index = 0;
    int u = 0, v = 0;
    double gap2 = 0;
  };
  std::vector<Within> within;
  for (std::uint32_t i = 0; i < open.size(); ++i) {
    const int u = component.number_of[to_index(open[i].first)], v = component.number_of[to_index(open[i].second)];
    if (u != ComponentEdges::kOutside && v != ComponentEdges::kOutside) {
      within.push_back({i, u, v, 0});
      component.edges.push_back({u, v, 1.0});
    } else if (order.joining.size() < count) {
      order.joining.push_back(i);
    }
  }
  if (within.empty()) return order;
  const FiedlerIteration reachable =
      near_fiedler(static_cast<int>(largest.vertices.size()), component.edges, largest.connectivity.fiedler);
  for (Within& w : within) {
    const double gap = reachable.vector[w.u] - reachable.vector[w.v];
    w.gap2 = gap * gap;
  }
  const std::size_t kept = std::min(count, within.size());
  std::ranges::partial_sort(
      within, within.begin() + static_cast<std::ptrdiff_t>(kept),
      [](const auto& a, const auto& b) { return a.gap2 != b.gap2 ? a.gap2 > b.gap2 : a.index < b.index; });
  for (std::size_t i = 0; i < kept; ++i) order.within.push_back(within[i].index);
  return order;
}

}  // namespace mapweld
