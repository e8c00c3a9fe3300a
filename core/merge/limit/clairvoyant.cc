#include "core/merge/limit/clairvoyant.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/connectivity_follower.h"
#include "core/graph/disjoint_sets.h"

namespace mapweld {
namespace {

constexpr double kTie = 1e-9;  // relative; gaps that differ by less are equal

class Clairvoyant {
 public:
  Clairvoyant(const AppearanceGraph& graph, std::span<const std::pair<VertexId, VertexId>> edges)
      : graph_(graph), edges_(edges), is_open_(edges.size()), sets_(graph.vertices()) {
    for (std::uint32_t v = 0; v < graph.vertices(); ++v) {
      for (const Neighbour& n : graph.neighbours(VertexId{v})) sets_.join(v, to_index(n.vertex));
      largest_ = std::max(largest_, sets_.size_of(v));
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto [u, v] = edges[e];
      if (std::max(to_index(u), to_index(v)) >= graph.vertices()) {
        throw std::invalid_argument("an edge ends outside of the graph");
      }
      is_open_[e] = u != v && !graph.has_edge(u, v);
    }
    if (is_whole()) return;
    AppearanceGraph all = graph;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (is_open_[e]) all.add_edge(edges[e].first, edges[e].second, 1);
    }
    last_fiedler_ = algebraic_connectivity(all).fiedler;
  }

  std::vector<ClairvoyantPick> order(const ClairvoyantOptions& options) {
    std::vector<ClairvoyantPick> picks;
    double connectivity = solve();
    while (picks.size() < options.max_picks && connectivity < options.goal) {
      const std::optional<std::uint32_t> next = is_whole() ? widest_gap() : best_join();
      if (!next) break;
      take(*next);
      connectivity = solve();
      picks.push_back({*next, connectivity});
    }
    return picks;
  }

 private:
  bool is_whole() const { return largest_ == graph_.vertices(); }
  // lambda_2 of the graph.
  double solve() { return is_whole() ? follower_.refresh(graph_).connectivity.value : 0; }

  double gap(const Eigen::VectorXd& x, std::uint32_t e) const {
    return x.size() == 0 ? 0 : std::abs(x[to_index(edges_[e].first)] - x[to_index(edges_[e].second)]);
  }

  std::optional<std::uint32_t> best_join() const {
    std::optional<std::uint32_t> best;
    std::uint32_t greatest = 0;
    double widest = 0;
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const std::uint32_t u = to_index(edges_[e].first), v = to_index(edges_[e].second);
      if (!is_open_[e] || sets_.root(u) == sets_.root(v)) continue;
      const std::uint32_t size = std::max(largest_, sets_.size_of(u) + sets_.size_of(v));
      const double gap_of_edge = gap(last_fiedler_, e);
      if (best && (size < greatest || (size == greatest && gap_of_edge <= widest * (1 + kTie)))) continue;
      best = e;
      greatest = size;
      widest = gap_of_edge;
    }
    return best;
  }

  std::optional<std::uint32_t> widest_gap() const {
    const Eigen::VectorXd& fiedler = follower_.last().connectivity.fiedler;
    std::optional<std::uint32_t> best;
    double widest = 0;
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      if (!is_open_[e]) continue;
      const double gap_of_edge = gap(fiedler, e);
      if (best && gap_of_edge <= widest * (1 + kTie)) continue;
      best = e;
      widest = gap_of_edge;
    }
    return best;
  }

  void take(std::uint32_t e) {
    const auto [u, v] = edges_[e];
    graph_.add_edge(u, v, 1);
    sets_.join(to_index(u), to_index(v));
    largest_ = std::max(largest_, sets_.size_of(to_index(u)));
    for (std::size_t other = e; other < edges_.size(); ++other) {
      if (edges_[other] == edges_[e] || edges_[other] == std::pair(v, u)) is_open_[other] = false;
    }
  }

  AppearanceGraph graph_;
  std::span<const std::pair<VertexId, VertexId>> edges_;
  std::vector<bool> is_open_;  // by edge: neither taken nor there from the start
  DisjointSets sets_;
  std::uint32_t largest_ = 0;      // vertices of the largest component
  Eigen::VectorXd last_fiedler_;   // of the graph with all edges; empty where it is not needed, or not connected
  ConnectivityFollower follower_;  // of the graph, once it is in one piece
};

}  // namespace

std::vector<ClairvoyantPick> clairvoyant_order(const AppearanceGraph& graph,
                                               std::span<const std::pair<VertexId, VertexId>> edges,
                                               const ClairvoyantOptions& options) {
  return Clairvoyant(graph, edges).order(options);
}

}  // namespace mapweld
