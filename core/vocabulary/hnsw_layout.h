// An HNSW graph laid out for search: what a step needs next lies in one cache line, and no step looks anything up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vocabulary/hnsw_graph.h"

namespace mapweld {

struct alignas(64) CacheLine {
  std::uint8_t bytes[64];
};

// A level above the lowest. Nodes are spoken of by their position in `words`, so that links lead straight on.
struct HnswUpperLevel {
  std::vector<std::uint32_t> words;    // by position
  std::vector<std::uint32_t> below;    // by position: position on the level below; on level 1, the word
  std::vector<std::uint32_t> offsets;  // links of position i: links[offsets[i] .. offsets[i + 1])
  std::vector<std::uint32_t> links;    // positions
};

// The lowest level: every word has as many links as the best connected one, missing ones lead to itself. With the usual
// 32 links, and words that fit 16 bits, they fill one cache line.
template <typename Word>
class HnswLowestLevel {
 public:
  HnswLowestLevel() = default;
  explicit HnswLowestLevel(const HnswGraph::Level& level);

  std::size_t stride() const { return stride_; }
  const Word* links(std::uint32_t word) const {
    return reinterpret_cast<const Word*>(lines_.data()) + std::size_t{word} * stride_;
  }

 private:
  std::size_t stride_ = 0;
  std::vector<CacheLine> lines_;
};

struct HnswLayout {
  explicit HnswLayout(const HnswGraph& graph);  // throws FormatError when levels do not fit together

  std::uint32_t words = 0;
  std::uint32_t entry = 0;                // position on the highest level; the word itself when there is but one
  std::vector<HnswUpperLevel> upper;      // level 1 first
  HnswLowestLevel<std::uint16_t> narrow;  // the lowest level, when words fit 16 bits
  HnswLowestLevel<std::uint32_t> wide;    // and when not
  bool is_narrow = false;
};

}  // namespace mapweld
