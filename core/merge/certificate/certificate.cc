#include "core/merge/certificate/certificate.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/graph/approximate_cholesky.h"
#include "core/graph/components.h"
#include "core/graph/disjoint_sets.h"
#include "core/graph/fiedler_iteration.h"
#include "core/graph/sparsify.h"

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
    const double chance = c.chance > 0 ? std::min(c.chance, 1.0) : 0.0;
    result.push_back({std::min(c.u, c.v), std::max(c.u, c.v), chance});
  }
  std::ranges::sort(result, [](const OpenCandidate& a, const OpenCandidate& b) {
    if (a.u != b.u) return a.u < b.u;
    return a.v != b.v ? a.v < b.v : a.chance > b.chance;
  });
  const auto repeated = std::ranges::unique(
      result, [](const OpenCandidate& a, const OpenCandidate& b) { return a.u == b.u && a.v == b.v; });
  result.erase(repeated.begin(), repeated.end());
  return result;
}

// Vertices of other components in the same set as K.
std::uint32_t brought_in(const Components& components, std::uint32_t largest, const DisjointSets& sets) {
  std::uint32_t vertices = 0;
  for (std::uint32_t c = 0; c < components.count(); ++c) {
    if (c != largest && sets.root(c) == sets.root(largest)) vertices += components.sizes[c];
  }
  return vertices;
}

void count_joinable(const Components& components, std::uint32_t largest, std::span<const OpenCandidate> open,
                    double likely, Certificate& result) {
  struct Join {
    std::uint32_t a, b;
    double miss;  // chance that none passes
  };
  std::vector<Join> joins;
  DisjointSets possible(components.count());
  for (const OpenCandidate& c : open) {
    const auto [a, b] = std::minmax({components.component_of[to_index(c.u)], components.component_of[to_index(c.v)]});
    if (a == b) continue;
    possible.join(a, b);
    joins.push_back({a, b, 1 - c.chance});
  }
  result.joinable_vertices = brought_in(components, largest, possible);
  std::ranges::stable_sort(joins, [](const Join& x, const Join& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
  DisjointSets probable(components.count());
  for (std::size_t k = 0; k < joins.size();) {
    const Join first = joins[k];
    double miss = 1;
    for (; k < joins.size() && joins[k].a == first.a && joins[k].b == first.b; ++k) miss *= joins[k].miss;
    if (1 - miss >= likely) probable.join(first.a, first.b);
  }
  result.likely_joinable_vertices = brought_in(components, largest, probable);
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
    const Components components = connected_components(graph);
    count_joinable(components, components.largest(), candidates, options.likely, result);
  }

  constexpr int kOutside = -1;
  std::vector<int> inside(graph.vertices(), kOutside);
  for (std::size_t i = 0; i < largest.vertices.size(); ++i) inside[to_index(largest.vertices[i])] = static_cast<int>(i);
  std::vector<OpenCandidate> within;
  for (const OpenCandidate& c : candidates) {
    if (inside[to_index(c.u)] != kOutside && inside[to_index(c.v)] != kOutside) within.push_back(c);
  }
  result.open_within = within.size();
  if (within.empty()) return result;

  std::vector<LaplacianEdge> edges;
  edges.reserve(graph.edges() + within.size());
  for (const VertexId u : largest.vertices) {
    for (const Neighbour& n : graph.neighbours(u)) {
      if (u < n.vertex) edges.push_back({inside[to_index(u)], inside[to_index(n.vertex)], 1.0});
    }
  }
  const std::size_t inner = edges.size();
  const int n = static_cast<int>(largest.vertices.size());
  FiedlerIterationOptions iteration;
  iteration.tolerance = 1e-6;
  iteration.least_progress = options.least_progress;
  iteration.max_iterations = options.max_iterations;
  const auto solve = [&](const Eigen::VectorXd& start) {
    FiedlerIteration found = iterate_to_fiedler(
        n, edges, ApproximateCholesky(n, sparsify(n, edges, options.oversampling)), start, iteration);
    result.iterations += found.iterations;
    result.converged = result.converged && found.converged;
    return found;
  };

  for (const OpenCandidate& c : within) {
    if (c.chance > 0) edges.push_back({inside[to_index(c.u)], inside[to_index(c.v)], c.chance});
  }
  const FiedlerIteration expected = solve(largest.connectivity.fiedler);
  result.expected_upper_bound = expected.value;

  edges.resize(inner);
  for (const OpenCandidate& c : within) edges.push_back({inside[to_index(c.u)], inside[to_index(c.v)], 1.0});
  const FiedlerIteration reachable = solve(expected.vector);
  // Any vector's quotient is a bound; of two the better.
  result.upper_bound = std::min(reachable.value, rayleigh_quotient(largest.connectivity.fiedler, edges).value);

  result.certified_fraction = std::min(1.0, result.lower_bound / (result.upper_bound * (1 + kRounding)));
  result.estimated_fraction =
      std::clamp(result.lower_bound / result.expected_upper_bound, result.certified_fraction, 1.0);
  return result;
}

}  // namespace mapweld
