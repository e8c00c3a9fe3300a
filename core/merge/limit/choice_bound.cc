#include "core/merge/limit/choice_bound.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/graph/near_fiedler.h"

namespace mapweld {
namespace {

constexpr NearFiedlerOptions kIterate{.least_progress = 1e-6, .max_iterations = 60, .oversampling = 4};

constexpr double kOfGood = 0.9;
// Steps of 2 / (t + 2) would begin with a leap to few edges, where one piece after the other is the weakest.
constexpr int kFirstStep = 23;

// What a vector, or a mean of several, says: it allows lambda_2 no more than `within` and, for each edge chosen, `of`.
struct Allowance {
  double within = 0;
  std::vector<double> of;
};

// The `count` edges of which most is allowed, in no order.
std::vector<std::uint32_t> greatest(const std::vector<double>& of, std::uint32_t count) {
  std::vector<std::uint32_t> order(of.size());
  std::iota(order.begin(), order.end(), 0u);
  if (count < order.size()) {
    std::ranges::nth_element(order, order.begin() + count,
                             [&](std::uint32_t a, std::uint32_t b) { return of[a] != of[b] ? of[a] > of[b] : a < b; });
    order.resize(count);
  }
  return order;
}

double bound_of(const Allowance& allowance, const std::vector<std::uint32_t>& chosen) {
  double bound = allowance.within;
  for (const std::uint32_t e : chosen) bound += allowance.of[e];
  return bound;
}

}  // namespace

double choice_bound(const AppearanceGraph& graph, std::span<const std::pair<VertexId, VertexId>> edges,
                    std::uint32_t count, const ChoiceBoundOptions& options) {
  AppearanceGraph whole = graph;
  for (const auto& [u, v] : edges) {
    if (!whole.add_edge(u, v, 1)) throw std::invalid_argument("an edge is there twice");
  }
  const AlgebraicConnectivity final_connectivity = algebraic_connectivity(whole);
  if (!(final_connectivity.value > 0)) throw std::invalid_argument("the graph with all edges is in pieces");
  if (count >= edges.size()) return final_connectivity.value;
  if (count + 1 < connected_components(graph).count()) return 0;
  if (count == 0) return algebraic_connectivity(graph).value;

  const int n = static_cast<int>(graph.vertices());
  std::vector<LaplacianEdge> weighted;
  for (const Edge& e : graph.edge_list()) {
    weighted.push_back({static_cast<int>(to_index(e.u)), static_cast<int>(to_index(e.v)), 1.0});
  }
  const std::size_t inner = weighted.size();
  const double kept = options.good.size() >= count ? kOfGood : 0;  // of the weights
  const double share = (1 - kept) * count / static_cast<double>(edges.size());
  for (const auto& [u, v] : edges) {
    weighted.push_back({static_cast<int>(to_index(u)), static_cast<int>(to_index(v)), share});
  }
  for (std::uint32_t i = 0; i < count && kept > 0; ++i) weighted.at(inner + options.good[i]).weight += kept;
  const auto allowance_of = [&](const Eigen::VectorXd& x) {
    Allowance allowance;
    allowance.of.reserve(edges.size());
    for (std::size_t e = 0; e < weighted.size(); ++e) {
      const double gap = (x[weighted[e].u] - x[weighted[e].v]) * (x[weighted[e].u] - x[weighted[e].v]);
      if (e < inner) {
        allowance.within += gap;
      } else {
        allowance.of.push_back(gap);
      }
    }
    return allowance;
  };

  Eigen::VectorXd x = final_connectivity.fiedler;
  double bound = final_connectivity.value;
  Allowance mean;
  mean.of.assign(edges.size(), 0);
  for (int t = 0; t < options.iterations; ++t) {
    const Allowance allowance = allowance_of(x);
    bound = std::min(bound, bound_of(allowance, greatest(allowance.of, count)));
    const double step = 2.0 / (t + 2);  // the whole of the first
    mean.within += step * (allowance.within - mean.within);
    for (std::size_t e = 0; e < edges.size(); ++e) mean.of[e] += step * (allowance.of[e] - mean.of[e]);
    const std::vector<std::uint32_t> chosen = greatest(mean.of, count);
    bound = std::min(bound, bound_of(mean, chosen));
    // Always a part of the way: no edge ever has weight 0.
    const double towards = 2.0 / (t + kFirstStep);
    for (std::size_t e = inner; e < weighted.size(); ++e) weighted[e].weight *= 1 - towards;
    for (const std::uint32_t e : chosen) weighted[inner + e].weight += towards;
    x = near_fiedler(n, weighted, x, kIterate).vector;
  }
  return bound;
}

}  // namespace mapweld
