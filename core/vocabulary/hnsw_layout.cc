#include "core/vocabulary/hnsw_layout.h"

#include <algorithm>

#include "core/errors.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kNarrowWords = 1u << 16;

std::uint32_t position(const std::vector<std::uint32_t>& ascending, std::uint32_t node) {
  const auto at = std::lower_bound(ascending.begin(), ascending.end(), node);
  if (at == ascending.end() || *at != node) throw FormatError("HNSW graph: a link leads off its level");
  return static_cast<std::uint32_t>(at - ascending.begin());
}

std::vector<std::uint32_t> positions(const std::vector<std::uint32_t>& ascending,
                                     const std::vector<std::uint32_t>& nodes) {
  std::vector<std::uint32_t> found(nodes.size());
  std::transform(nodes.begin(), nodes.end(), found.begin(),
                 [&](std::uint32_t node) { return position(ascending, node); });
  return found;
}

}  // namespace

template <typename Word>
HnswLowestLevel<Word>::HnswLowestLevel(const HnswGraph::Level& level) {
  constexpr std::size_t kWordsPerLine = sizeof(CacheLine) / sizeof(Word);
  const auto size = static_cast<std::uint32_t>(level.nodes.size());
  std::size_t most = 1;
  for (std::uint32_t word = 0; word < size; ++word) {
    most = std::max<std::size_t>(most, level.offsets[word + 1] - level.offsets[word]);
  }
  const std::size_t lines_per_word = (most + kWordsPerLine - 1) / kWordsPerLine;
  stride_ = lines_per_word * kWordsPerLine;
  lines_.resize(lines_per_word * size);
  auto* row = reinterpret_cast<Word*>(lines_.data());
  for (std::uint32_t word = 0; word < size; ++word, row += stride_) {
    std::fill_n(row, stride_, static_cast<Word>(word));
    std::transform(level.links.begin() + level.offsets[word], level.links.begin() + level.offsets[word + 1], row,
                   [](std::uint32_t link) { return static_cast<Word>(link); });
  }
}

template class HnswLowestLevel<std::uint16_t>;
template class HnswLowestLevel<std::uint32_t>;

HnswLayout::HnswLayout(const HnswGraph& graph) : words(graph.size), is_narrow(graph.size <= kNarrowWords) {
  if (graph.size == 0) throw FormatError("HNSW graph: no words");
  if (is_narrow) {
    narrow = HnswLowestLevel<std::uint16_t>(graph.levels[0]);
  } else {
    wide = HnswLowestLevel<std::uint32_t>(graph.levels[0]);
  }
  for (std::size_t i = 1; i < graph.levels.size(); ++i) {
    const HnswGraph::Level& level = graph.levels[i];
    upper.push_back({level.nodes, positions(graph.levels[i - 1].nodes, level.nodes), level.offsets,
                     positions(level.nodes, level.links)});
  }
  entry = position(graph.levels.back().nodes, graph.entry);
}

}  // namespace mapweld
