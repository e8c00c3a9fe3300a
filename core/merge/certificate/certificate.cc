#include "core/merge/certificate/certificate.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/graph/component_edges.h"
#include "core/graph/components.h"
#include "core/graph/disjoint_sets.h"

namespace mapweld {
namespace {

// What sums of a few hundred thousand products of doubles may be wrong by, relative, many times over.
constexpr double kRounding = 1e-11;

// u < v, ascending, each pair once, no edges of the graph.
std::vector<OpenCandidate> remaining(const AppearanceGraph& graph, std::span<const OpenCandidate> open) {
  std::vector<OpenCandidate> result;
  result.reserve(open.size());
  for (const OpenCandidate& c : open) {
    if (c.u == c.v) throw std::invalid_argument("a candidate joins two distinct vertices");
    if (to_index(std::max(c.u, c.v)) >= graph.vertices()) {
      throw std::invalid_argument("candidate (" + std::to_string(to_index(c.u)) + ", " + std::to_string(to_index(c.v)) +
                                  ") in a graph of " + std::to_string(graph.vertices()) + " vertices");
    }
    if (graph.has_edge(c.u, c.v)) continue;
    result.push_back({std::min(c.u, c.v), std::max(c.u, c.v), 0, {}});
  }
  const auto ends = [](const OpenCandidate& c) { return std::pair(c.u, c.v); };
  std::ranges::sort(result, {}, ends);
  const auto repeated = std::ranges::unique(result, {}, ends);
  result.erase(repeated.begin(), repeated.end());
  return result;
}

// See Certificate::joinable_vertices.
std::uint32_t joinable(const Components& components, std::span<const OpenCandidate> open) {
  DisjointSets sets(components.count());
  for (const OpenCandidate& c : open) {
    sets.join(components.component_of[to_index(c.u)], components.component_of[to_index(c.v)]);
  }
  const std::uint32_t largest = components.largest(), size = components.sizes[largest];
  struct Reach {
    std::uint32_t vertices = 0;
    std::uint32_t first = 0;  // component: of equal sizes the one that begins with the lowest vertex is the largest
  };
  std::map<std::uint32_t, Reach> reached;  // by set
  for (std::uint32_t c = 0; c < components.count(); ++c) {
    const auto [reach, is_new] = reached.try_emplace(sets.root(c), Reach{0, c});
    reach->second.vertices += components.sizes[c];
  }
  std::uint32_t vertices = 0;
  for (const auto& [root, reach] : reached) {
    if (root == sets.root(largest)) {
      vertices += reach.vertices - size;
    } else if (reach.vertices > size || (reach.vertices == size && reach.first < largest)) {
      vertices += reach.vertices;
    }
  }
  return vertices;
}

}  // namespace

Certificate certify(const AppearanceGraph& graph, std::span<const OpenCandidate> open,
                    const CertificateOptions& options) {
  return certify(graph, largest_component_connectivity(graph), open, options);
}

Certificate certify(const AppearanceGraph& graph, const LargestComponentConnectivity& largest,
                    std::span<const OpenCandidate> open, const CertificateOptions& options) {
  Certificate result;
  const std::vector<OpenCandidate> candidates = remaining(graph, open);
  if (graph.vertices() == 0) return result;
  result.vertices = static_cast<std::uint32_t>(largest.vertices.size());
  result.lower_bound = std::max(0.0, largest.connectivity.value * (1 - kRounding) - largest.connectivity.residual);
  if (largest.components > 1) {
    result.joinable_vertices = joinable(connected_components(graph), candidates);
  }

  ComponentEdges within = component_edges(graph, largest.vertices);
  const std::size_t edges_now = within.edges.size();
  for (const OpenCandidate& c : candidates) {
    const int u = within.number_of[to_index(c.u)], v = within.number_of[to_index(c.v)];
    if (u != ComponentEdges::kOutside && v != ComponentEdges::kOutside) within.edges.push_back({u, v, 1.0});
  }
  result.open_within = within.edges.size() - edges_now;
  if (result.open_within == 0) return result;

  const FiedlerIteration reachable = near_fiedler(static_cast<int>(largest.vertices.size()), within.edges,
                                                  largest.connectivity.fiedler, options.iteration);
  result.iterations = reachable.iterations;
  result.converged = reachable.converged;
  // Any vector's quotient is a bound; of two the better.
  result.upper_bound = std::min(reachable.value, rayleigh_quotient(largest.connectivity.fiedler, within.edges).value);

  result.certified_fraction = std::min(1.0, result.lower_bound / (result.upper_bound * (1 + kRounding)));
  return result;
}

}  // namespace mapweld
