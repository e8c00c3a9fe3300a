#include "core/graph/edge_connectivity.h"

#include <algorithm>
#include <queue>
#include <utility>
#include <vector>

#include "core/graph/components.h"
#include "core/graph/degrees.h"
#include "core/graph/disjoint_sets.h"

namespace mapweld {
namespace {

struct Arc {
  std::uint32_t to;
  std::uint64_t weight;
};
using Multigraph = std::vector<std::vector<Arc>>;  // parallel edges merged into one weight

// One maximum adjacency scan. Joins the ends of every edge whose bound reaches `best`, and lowers `best` to
// every cut that the scan comes across. Joins at least one pair.
void scan(const Multigraph& graph, std::uint64_t& best, DisjointSets& contracted) {
  const auto n = static_cast<std::uint32_t>(graph.size());
  std::vector<std::uint64_t> attachment(n, 0);
  std::vector<std::uint8_t> scanned(n, 0);
  std::priority_queue<std::pair<std::uint64_t, std::uint32_t>> queue;
  queue.emplace(0, 0);
  std::uint64_t cut = 0;  // between the scanned vertices and the others
  std::uint32_t left = n;
  while (!queue.empty()) {
    const auto [priority, u] = queue.top();
    queue.pop();
    if (scanned[u] || priority != attachment[u]) continue;
    scanned[u] = 1;
    --left;
    std::uint64_t degree = 0;
    for (const Arc& arc : graph[u]) degree += arc.weight;
    cut += degree;
    cut -= 2 * attachment[u];
    if (left > 0) best = std::min(best, cut);
    for (const Arc& arc : graph[u]) {
      if (scanned[arc.to]) continue;
      attachment[arc.to] += arc.weight;
      if (attachment[arc.to] >= best) contracted.join(arc.to, u);
      queue.emplace(attachment[arc.to], arc.to);
    }
  }
}

Multigraph contract(const Multigraph& graph, const DisjointSets& contracted) {
  const auto n = static_cast<std::uint32_t>(graph.size());
  std::vector<std::uint32_t> number(n, 0xFFFFFFFF);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < n; ++v) {
    std::uint32_t& of_root = number[contracted.root(v)];
    if (of_root == 0xFFFFFFFF) of_root = count++;
  }
  Multigraph result(count);
  for (std::uint32_t v = 0; v < n; ++v) {
    const std::uint32_t from = number[contracted.root(v)];
    for (const Arc& arc : graph[v]) {
      const std::uint32_t to = number[contracted.root(arc.to)];
      if (from != to) result[from].push_back({to, arc.weight});
    }
  }
  for (std::vector<Arc>& arcs : result) {
    std::ranges::sort(arcs, {}, &Arc::to);
    std::size_t kept = 0;
    for (const Arc& arc : arcs) {
      if (kept > 0 && arcs[kept - 1].to == arc.to) {
        arcs[kept - 1].weight += arc.weight;
      } else {
        arcs[kept++] = arc;
      }
    }
    arcs.resize(kept);
  }
  return result;
}

}  // namespace

std::uint32_t edge_connectivity(const AppearanceGraph& graph) {
  if (graph.vertices() < 2 || connected_components(graph).count() != 1) return 0;
  std::uint64_t best = min_degree(graph);
  Multigraph multigraph(graph.vertices());
  for (std::uint32_t u = 0; u < graph.vertices(); ++u) {
    for (const Neighbour& n : graph.neighbours(VertexId{u})) multigraph[u].push_back({to_index(n.vertex), 1});
  }
  while (multigraph.size() > 1 && best > 1) {
    DisjointSets contracted(static_cast<std::uint32_t>(multigraph.size()));
    scan(multigraph, best, contracted);
    multigraph = contract(multigraph, contracted);
    for (const std::vector<Arc>& arcs : multigraph) {
      std::uint64_t degree = 0;
      for (const Arc& arc : arcs) degree += arc.weight;
      if (multigraph.size() > 1) best = std::min(best, degree);
    }
  }
  return static_cast<std::uint32_t>(best);
}

}  // namespace mapweld
