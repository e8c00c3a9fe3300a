// A hierarchical navigable small world graph over byte descriptors (Malkov & Yashunin 2018), as a value: who is linked
// with whom, level by level. hnswlib builds it; HnswIndex searches it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mapweld {

struct HnswGraph {
  // A level holds ever fewer nodes; the lowest holds all. The links of nodes[i] are
  // links[offsets[i] .. offsets[i + 1]), ascending.
  struct Level {
    std::vector<std::uint32_t> nodes;  // ascending
    std::vector<std::uint32_t> offsets{0};
    std::vector<std::uint32_t> links;
    friend bool operator==(const Level&, const Level&) = default;
  };
  std::uint32_t size = 0;     // nodes, numbered 0 .. size-1
  std::uint32_t entry = 0;    // where a search starts, on the highest level
  std::vector<Level> levels;  // lowest first; empty when size is 0
  friend bool operator==(const HnswGraph&, const HnswGraph&) = default;
};

struct HnswBuildOptions {
  int links = 16;          // M: links a node keeps when it is inserted; twice as many on the lowest level
  int build_effort = 200;  // ef_construction
  std::uint32_t seed = 1;
};

// Builds the graph over `points` (N x 128 bytes, row-major), inserted by one thread in an order shuffled by the seed
// (points that come sorted would make a worse graph): repeatable.
HnswGraph build_hnsw_graph(std::span<const std::uint8_t> points, const HnswBuildOptions& options);

// Bytes that compress well (docs/vocabulary.md, "The graph"), and back. Throws FormatError for torn bytes, a link that
// leads nowhere or a graph over other than `size` nodes: what was read can be searched without looking again.
std::vector<std::uint8_t> encode_hnsw_graph(const HnswGraph& graph);
HnswGraph decode_hnsw_graph(std::span<const std::uint8_t> bytes, std::uint32_t size);

}  // namespace mapweld
