#include "core/merge/certificate/final_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/graph/component_edges.h"
#include "core/graph/components.h"
#include "core/graph/disjoint_sets.h"
#include "core/random.h"

namespace mapweld {
namespace {

// In [0, 1), of a place and a sample.
double draw(const OpenCandidate& c, int sample) {
  const auto [a, b] = c.place.value_or(std::minmax(c.u, c.v));
  std::uint64_t state =
      (std::uint64_t{to_index(a)} << 32 | to_index(b)) + static_cast<std::uint64_t>(sample) * 0x5851F42D4C957F2Dull;
  next_random(state);
  return static_cast<double>(next_random(state) >> 11) * 0x1p-53;
}

// x^(5/8) by square roots: std::pow may differ in the last bit from one processor to another.
double brought_up(double x) { return std::sqrt(x) * std::sqrt(std::sqrt(std::sqrt(x))); }

}  // namespace

FinalEstimate estimate_final(const AppearanceGraph& graph, const LargestComponentConnectivity& largest,
                             std::span<const OpenCandidate> open, const FinalEstimateOptions& options) {
  if (largest.vertices.empty() || open.empty()) return {};
  const Components components = connected_components(graph);
  ComponentEdges within = component_edges(graph, largest.vertices);
  const std::size_t edges_now = within.edges.size();
  std::vector<OpenCandidate> candidates;
  for (const OpenCandidate& c : open) {
    if (!graph.has_edge(c.u, c.v)) candidates.push_back({std::min(c.u, c.v), std::max(c.u, c.v), c.chance, c.place});
  }
  const auto ends = [](const OpenCandidate& c) { return std::pair(c.u, c.v); };
  std::ranges::sort(candidates, {}, [&](const OpenCandidate& c) { return std::pair(ends(c), -c.chance); });
  const auto repeated = std::ranges::unique(candidates, {}, ends);
  candidates.erase(repeated.begin(), repeated.end());

  FinalEstimate sum{0, 0};
  for (int sample = 0; sample < options.samples; ++sample) {
    DisjointSets joined(components.count());
    within.edges.resize(edges_now);
    for (const OpenCandidate& c : candidates) {
      if (draw(c, sample) >= c.chance) continue;
      joined.join(components.component_of[to_index(c.u)], components.component_of[to_index(c.v)]);
      const int u = within.number_of[to_index(c.u)], v = within.number_of[to_index(c.v)];
      if (u != ComponentEdges::kOutside && v != ComponentEdges::kOutside) within.edges.push_back({u, v, 1.0});
    }
    std::vector<std::size_t> size(components.count(), 0);
    for (std::uint32_t c = 0; c < components.count(); ++c) size[joined.root(c)] += components.sizes[c];
    sum.vertices_share +=
        static_cast<double>(largest.vertices.size()) / static_cast<double>(*std::ranges::max_element(size));
    double fraction = 1;
    if (within.edges.size() > edges_now) {
      const double end = near_fiedler(static_cast<int>(largest.vertices.size()), within.edges,
                                      largest.connectivity.fiedler, options.iteration)
                             .value;
      fraction = std::min(1.0, largest.connectivity.value / end);
    }
    sum.fraction += fraction;
  }
  const double mean = sum.fraction / options.samples;
  return {options.is_brought_up ? brought_up(mean) : mean, sum.vertices_share / options.samples};
}

}  // namespace mapweld
