#include "core/graph/matching.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/max_cardinality_matching.hpp>

#include "core/graph/deep_stack.h"

namespace mapweld {
namespace {

using SparseGraph = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS>;
using Vertex = SparseGraph::vertex_descriptor;
const Vertex kNobody = SparseGraph::null_vertex();

// Boost follows an augmenting path through odd cycles by recursion, at worst through all vertices. A frame takes some
// 150 bytes, under AddressSanitizer 1,100.
constexpr std::size_t kVerticesOnUsualStack = 2000, kStackBytesPerVertex = 2048;

// The vertices that have an edge, numbered as they come.
SparseGraph compact_graph(std::span<const std::pair<VertexId, VertexId>> edges) {
  std::vector<Vertex> numbers;
  Vertex count = 0;
  const auto number = [&](VertexId v) {
    if (to_index(v) >= numbers.size()) numbers.resize(to_index(v) + std::size_t{1}, kNobody);
    Vertex& known = numbers[to_index(v)];
    if (known == kNobody) known = count++;
    return known;
  };
  SparseGraph graph;
  for (const auto& [u, v] : edges) {
    if (u != v) boost::add_edge(number(u), number(v), graph);
  }
  return graph;
}

// A vertex with one free neighbour loses nothing by taking it; where there is none, the one that had fewest to begin
// with takes the neighbour that has fewest left.
template <typename Graph, typename MateMap>
class KarpSipser {
 public:
  static void find_matching(const Graph& graph, MateMap mate) { KarpSipser(graph, mate).run(); }

 private:
  KarpSipser(const Graph& graph, MateMap mate) : graph_(graph), mate_(mate), free_(num_vertices(graph)) {
    for (Vertex v = 0; v < free_.size(); ++v) {
      mate_[v] = kNobody;
      free_[v] = out_degree(v, graph);
    }
  }

  void run() {
    std::vector<Vertex> order(free_.size());
    std::iota(order.begin(), order.end(), Vertex{0});
    std::ranges::stable_sort(order, {}, [this](Vertex v) { return free_[v]; });
    for (const Vertex v : order) {
      take(v);
      while (!forced_.empty()) {
        const Vertex forced = forced_.back();
        forced_.pop_back();
        take(forced);
      }
    }
  }

  void take(Vertex u) {
    if (mate_[u] != kNobody) return;
    Vertex best = kNobody;
    for (const Vertex v : boost::make_iterator_range(adjacent_vertices(u, graph_))) {
      if (mate_[v] == kNobody && (best == kNobody || free_[v] < free_[best])) best = v;
    }
    if (best == kNobody) return;
    mate_[u] = best;
    mate_[best] = u;
    for (const Vertex taken : {u, best}) {
      for (const Vertex v : boost::make_iterator_range(adjacent_vertices(taken, graph_))) {
        if (--free_[v] == 1 && mate_[v] == kNobody) forced_.push_back(v);
      }
    }
  }

  const Graph& graph_;
  MateMap mate_;
  std::vector<std::size_t> free_;  // neighbours without a mate, repeated ones repeatedly
  std::vector<Vertex> forced_;
};

}  // namespace

std::uint32_t maximum_matching(std::span<const std::pair<VertexId, VertexId>> edges) {
  const SparseGraph graph = compact_graph(edges);
  std::vector<Vertex> mates(num_vertices(graph));
  const auto index = get(boost::vertex_index, graph);
  const auto match = [&] {
    boost::matching<SparseGraph, Vertex*, decltype(index), boost::edmonds_augmenting_path_finder, KarpSipser,
                    boost::no_matching_verifier>(graph, mates.data(), index);
  };
  if (mates.size() <= kVerticesOnUsualStack) {
    match();
  } else {
    run_on_stack(mates.size() * kStackBytesPerVertex, match);
  }
  return static_cast<std::uint32_t>((mates.size() - std::ranges::count(mates, kNobody)) / 2);
}

}  // namespace mapweld
