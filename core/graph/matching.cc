#include "core/graph/matching.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace mapweld {
namespace {

constexpr int kNone = -1;
using Adjacency = std::vector<std::vector<int>>;

Adjacency compact_graph(std::span<const std::pair<VertexId, VertexId>> edges) {
  std::vector<VertexId> ids;
  ids.reserve(2 * edges.size());
  for (const auto& [u, v] : edges) {
    ids.push_back(u);
    ids.push_back(v);
  }
  std::ranges::sort(ids);
  ids.erase(std::ranges::unique(ids).begin(), ids.end());
  const auto number = [&ids](VertexId v) { return static_cast<int>(std::ranges::lower_bound(ids, v) - ids.begin()); };
  Adjacency graph(ids.size());
  for (const auto& [u, v] : edges) {
    if (u == v) continue;
    graph[number(u)].push_back(number(v));
    graph[number(v)].push_back(number(u));
  }
  return graph;
}

// The side of each vertex, or nothing when an odd cycle exists.
std::optional<std::vector<int>> two_colour(const Adjacency& graph) {
  std::vector<int> side(graph.size(), kNone);
  std::vector<int> stack;
  for (std::size_t start = 0; start < graph.size(); ++start) {
    if (side[start] != kNone) continue;
    side[start] = 0;
    stack.push_back(static_cast<int>(start));
    while (!stack.empty()) {
      const int u = stack.back();
      stack.pop_back();
      for (const int v : graph[u]) {
        if (side[v] == kNone) {
          side[v] = 1 - side[u];
          stack.push_back(v);
        } else if (side[v] == side[u]) {
          return std::nullopt;
        }
      }
    }
  }
  return side;
}

class HopcroftKarp {
 public:
  HopcroftKarp(const Adjacency& graph, const std::vector<int>& side) : graph_(graph) {
    for (std::size_t v = 0; v < graph.size(); ++v) {
      if (side[v] == 0) left_.push_back(static_cast<int>(v));
    }
  }

  std::uint32_t run() {
    mate_.assign(graph_.size(), kNone);
    std::uint32_t matched = 0;
    while (layer()) {
      next_.assign(graph_.size(), 0);
      for (const int u : left_) {
        if (mate_[u] == kNone && augment(u)) ++matched;
      }
    }
    return matched;
  }

 private:
  static constexpr int kFar = std::numeric_limits<int>::max();

  // Breadth first from the free left vertices; whether a free right vertex is reached.
  bool layer() {
    distance_.assign(graph_.size(), kFar);
    std::vector<int> queue;
    for (const int u : left_) {
      if (mate_[u] == kNone) {
        distance_[u] = 0;
        queue.push_back(u);
      }
    }
    bool found = false;
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const int u = queue[head];
      for (const int v : graph_[u]) {
        const int w = mate_[v];
        if (w == kNone) {
          found = true;
        } else if (distance_[w] == kFar) {
          distance_[w] = distance_[u] + 1;
          queue.push_back(w);
        }
      }
    }
    return found;
  }

  // Depth first along the layers, with a stack of its own: paths may be as long as the graph.
  bool augment(int start) {
    std::vector<int> path{start};
    while (!path.empty()) {
      const int u = path.back();
      if (next_[u] == graph_[u].size()) {
        distance_[u] = kFar;
        path.pop_back();
        if (!path.empty()) ++next_[path.back()];
        continue;
      }
      const int v = graph_[u][next_[u]];
      const int w = mate_[v];
      if (w == kNone) {
        for (const int left : path) {
          const int right = graph_[left][next_[left]];
          mate_[right] = left;
          mate_[left] = right;
        }
        return true;
      }
      if (distance_[w] == distance_[u] + 1) {
        path.push_back(w);
      } else {
        ++next_[u];
      }
    }
    return false;
  }

  const Adjacency& graph_;
  std::vector<int> left_, mate_, distance_;
  std::vector<std::size_t> next_;
};

// Edmonds 1965, in the form that contracts a blossom by giving its vertices one base.
class Blossoms {
 public:
  explicit Blossoms(const Adjacency& graph) : graph_(graph), mate_(graph.size(), kNone) {}

  std::uint32_t run() {
    std::uint32_t matched = 0;
    for (std::size_t u = 0; u < graph_.size(); ++u) {  // a greedy start leaves few searches
      for (const int v : graph_[u]) {
        if (mate_[u] == kNone && mate_[v] == kNone) {
          mate_[u] = v;
          mate_[v] = static_cast<int>(u);
          ++matched;
        }
      }
    }
    for (std::size_t root = 0; root < graph_.size(); ++root) {
      if (mate_[root] != kNone) continue;
      const int end = search(static_cast<int>(root));
      if (end == kNone) continue;
      ++matched;
      for (int v = end; v != kNone;) {
        const int u = parent_[v], next = mate_[u];
        mate_[v] = u;
        mate_[u] = v;
        v = next;
      }
    }
    return matched;
  }

 private:
  int common_base(int a, int b) const {
    std::vector<std::uint8_t> seen(graph_.size(), 0);
    for (int u = a;; u = parent_[mate_[u]]) {
      u = base_[u];
      seen[u] = 1;
      if (mate_[u] == kNone) break;
    }
    for (int u = b;; u = parent_[mate_[u]]) {
      u = base_[u];
      if (seen[u]) return u;
    }
  }

  void mark_path(int v, int base, int child) {
    while (base_[v] != base) {
      in_blossom_[base_[v]] = in_blossom_[base_[mate_[v]]] = 1;
      parent_[v] = child;
      child = mate_[v];
      v = parent_[mate_[v]];
    }
  }

  // The free end of an augmenting path from `root`, or kNone.
  int search(int root) {
    const std::size_t n = graph_.size();
    parent_.assign(n, kNone);
    base_.resize(n);
    for (std::size_t v = 0; v < n; ++v) base_[v] = static_cast<int>(v);
    std::vector<std::uint8_t> used(n, 0);
    std::vector<int> queue{root};
    used[root] = 1;
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const int u = queue[head];
      for (const int v : graph_[u]) {
        if (base_[u] == base_[v] || mate_[u] == v) continue;
        if (v == root || (mate_[v] != kNone && parent_[mate_[v]] != kNone)) {
          const int base = common_base(u, v);
          in_blossom_.assign(n, 0);
          mark_path(u, base, v);
          mark_path(v, base, u);
          for (std::size_t w = 0; w < n; ++w) {
            if (!in_blossom_[base_[w]]) continue;
            base_[w] = base;
            if (!used[w]) {
              used[w] = 1;
              queue.push_back(static_cast<int>(w));
            }
          }
        } else if (parent_[v] == kNone) {
          parent_[v] = u;
          if (mate_[v] == kNone) return v;
          used[mate_[v]] = 1;
          queue.push_back(mate_[v]);
        }
      }
    }
    return kNone;
  }

  const Adjacency& graph_;
  std::vector<int> mate_, parent_, base_;
  std::vector<std::uint8_t> in_blossom_;
};

}  // namespace

std::uint32_t maximum_matching(std::span<const std::pair<VertexId, VertexId>> edges) {
  const Adjacency graph = compact_graph(edges);
  if (const auto side = two_colour(graph)) return HopcroftKarp(graph, *side).run();
  return Blossoms(graph).run();
}

}  // namespace mapweld
