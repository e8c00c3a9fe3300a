// Graphs with known spectra and cuts, and random ones, for the tests of core/graph.
#pragma once

#include <cstdint>
#include <random>

#include "core/graph/appearance_graph.h"

namespace mapweld::test {

inline AppearanceGraph path(std::uint32_t n) {
  AppearanceGraph graph(n);
  for (std::uint32_t v = 0; v + 1 < n; ++v) graph.add_edge(VertexId{v}, VertexId{v + 1}, 1);
  return graph;
}

inline AppearanceGraph cycle(std::uint32_t n) {
  AppearanceGraph graph = path(n);
  graph.add_edge(VertexId{n - 1}, VertexId{0}, 1);
  return graph;
}

inline AppearanceGraph star(std::uint32_t n) {
  AppearanceGraph graph(n);
  for (std::uint32_t v = 1; v < n; ++v) graph.add_edge(VertexId{0}, VertexId{v}, 1);
  return graph;
}

inline void add_clique(AppearanceGraph& graph, std::uint32_t first, std::uint32_t size) {
  for (std::uint32_t u = first; u < first + size; ++u) {
    for (std::uint32_t v = u + 1; v < first + size; ++v) graph.add_edge(VertexId{u}, VertexId{v}, 1);
  }
}

inline AppearanceGraph complete(std::uint32_t n) {
  AppearanceGraph graph(n);
  add_clique(graph, 0, n);
  return graph;
}

// Two cliques of n vertices each, joined by one edge.
inline AppearanceGraph barbell(std::uint32_t n) {
  AppearanceGraph graph(2 * n);
  add_clique(graph, 0, n);
  add_clique(graph, n, n);
  graph.add_edge(VertexId{n - 1}, VertexId{n}, 1);
  return graph;
}

inline AppearanceGraph grid(std::uint32_t width, std::uint32_t height) {
  AppearanceGraph graph(width * height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t v = y * width + x;
      if (x + 1 < width) graph.add_edge(VertexId{v}, VertexId{v + 1}, 1);
      if (y + 1 < height) graph.add_edge(VertexId{v}, VertexId{v + width}, 1);
    }
  }
  return graph;
}

// A random graph like a robot's map: a walk with links to the last few vertices and some to anywhere. Weights 1 to 60.
inline AppearanceGraph random_map(std::uint32_t n, int near_links, double far_share, std::uint32_t seed) {
  std::mt19937 random(seed);
  AppearanceGraph graph(n);
  for (std::uint32_t v = 1; v < n; ++v) {
    graph.add_edge(VertexId{v}, VertexId{v - 1}, 1 + random() % 60);
    for (int k = 0; k < near_links; ++k) {
      const std::uint32_t back = 1 + random() % 12;
      if (back <= v) graph.add_edge(VertexId{v}, VertexId{v - back}, 1 + random() % 60);
    }
    if (static_cast<double>(random() % 10000) < far_share * 10000) {
      graph.add_edge(VertexId{v}, VertexId{static_cast<std::uint32_t>(random() % v)}, 1 + random() % 60);
    }
  }
  return graph;
}

// Every pair is an edge with probability `share`.
inline AppearanceGraph random_graph(std::uint32_t n, double share, std::uint32_t seed) {
  std::mt19937 random(seed);
  AppearanceGraph graph(n);
  for (std::uint32_t u = 0; u < n; ++u) {
    for (std::uint32_t v = u + 1; v < n; ++v) {
      if (static_cast<double>(random() % 100000) < share * 100000) {
        graph.add_edge(VertexId{u}, VertexId{v}, 1 + random() % 60);
      }
    }
  }
  return graph;
}

}  // namespace mapweld::test
