#include "core/vocabulary/hnsw_index.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/errors.h"
#include "core/vocabulary/byte_stream.h"
#include "core/vocabulary/distance.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kFormat = 1;
constexpr int kMaxSearchEffort = 1 << 16;

// A word seen by a search: distance, then word, then whether its neighbours were looked at. One number, so that the
// beam is sorted by one comparison and ties go to the lower word.
using Seen = std::uint64_t;
constexpr Seen kExpanded = 1;
constexpr Seen make_seen(SquaredDistance distance, std::uint32_t node) {
  return Seen{distance} << 33 | Seen{node} << 1;
}
constexpr std::uint32_t node_of(Seen seen) { return static_cast<std::uint32_t>(seen >> 1); }

void prefetch_row(const std::uint8_t* row) {
  __builtin_prefetch(row);
  __builtin_prefetch(row + 64);
}

}  // namespace

// The scratch of one thread's queries.
class HnswIndex::Search {
 public:
  explicit Search(const HnswIndex& index)
      : index_(index), kernel_(distance_kernel()), visited_(index.graph_.size), beam_limit_(index.search_effort_) {
    beam_.reserve(beam_limit_ + 1);
  }

  std::uint32_t nearest(const std::uint8_t* query) {
    const HnswGraph& graph = index_.graph_;
    std::uint32_t start = graph.entry;
    SquaredDistance distance = kernel_.pair(query, row(start));
    for (std::size_t level = graph.levels.size(); level-- > 1;) descend(query, graph.levels[level], start, distance);
    return search_lowest(query, start, distance);
  }

 private:
  const std::uint8_t* row(std::uint32_t node) const {
    return index_.centroids_.data() + std::size_t{node} * kDescriptorDimension;
  }

  // Moves to the nearest neighbour until none is nearer.
  void descend(const std::uint8_t* query, const HnswGraph::Level& level, std::uint32_t& node,
               SquaredDistance& distance) {
    for (bool moved = true; moved;) {
      moved = false;
      const auto at = std::lower_bound(level.nodes.begin(), level.nodes.end(), node);
      if (at == level.nodes.end() || *at != node) return;
      const auto i = static_cast<std::size_t>(at - level.nodes.begin());
      fresh_.assign(level.links.begin() + level.offsets[i], level.links.begin() + level.offsets[i + 1]);
      measure(query);
      for (std::size_t k = 0; k < fresh_.size(); ++k) {
        if (make_seen(distances_[k], fresh_[k]) < make_seen(distance, node)) {
          distance = distances_[k];
          node = fresh_[k];
          moved = true;
        }
      }
    }
  }

  std::uint32_t search_lowest(const std::uint8_t* query, std::uint32_t start, SquaredDistance distance) {
    const HnswGraph::Level& level = index_.graph_.levels[0];
    next_epoch();
    visited_[start] = epoch_;
    beam_.assign(1, make_seen(distance, start));
    for (std::size_t at = 0; at < beam_.size();) {
      if ((beam_[at] & kExpanded) != 0) {
        ++at;
        continue;
      }
      beam_[at] |= kExpanded;
      const std::uint32_t node = node_of(beam_[at]);
      fresh_.clear();
      for (std::uint32_t k = level.offsets[node]; k < level.offsets[node + 1]; ++k) {
        const std::uint32_t link = level.links[k];
        if (visited_[link] == epoch_) continue;
        visited_[link] = epoch_;
        prefetch_row(row(link));
        fresh_.push_back(link);
      }
      measure(query);
      std::size_t lowest = beam_.size();
      for (std::size_t k = 0; k < fresh_.size(); ++k) {
        const Seen seen = make_seen(distances_[k], fresh_[k]);
        if (beam_.size() == beam_limit_ && seen > beam_.back()) continue;
        const auto place = std::upper_bound(beam_.begin(), beam_.end(), seen);
        lowest = std::min(lowest, static_cast<std::size_t>(place - beam_.begin()));
        if (beam_.size() == beam_limit_) beam_.pop_back();
        beam_.insert(place, seen);
      }
      at = std::min(at + 1, lowest);
    }
    return node_of(beam_.front());
  }

  void measure(const std::uint8_t* query) {
    distances_.resize(fresh_.size());
    kernel_.gather(query, index_.centroids_.data(), fresh_.data(), fresh_.size(), distances_.data());
  }

  void next_epoch() {
    if (++epoch_ == 0) {
      std::fill(visited_.begin(), visited_.end(), std::uint16_t{0});
      epoch_ = 1;
    }
  }

  const HnswIndex& index_;
  const DistanceKernel& kernel_;
  std::vector<std::uint16_t> visited_;  // by node: the epoch of the query that saw it last
  std::uint16_t epoch_ = 0;
  std::size_t beam_limit_;
  std::vector<Seen> beam_;  // ascending
  std::vector<std::uint32_t> fresh_;
  std::vector<SquaredDistance> distances_;
};

HnswIndex::HnswIndex(std::span<const std::uint8_t> centroids, HnswGraph graph, int search_effort)
    : centroids_(centroids), graph_(std::move(graph)), search_effort_(search_effort) {
  if (search_effort_ < 1 || search_effort_ > kMaxSearchEffort) throw FormatError("HNSW: search effort out of range");
}

void HnswIndex::quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const {
  if (graph_.size == 0) throw FormatError("HNSW: a vocabulary without words");
  Search search(*this);
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = WordId{search.nearest(descriptors.data() + i * kDescriptorDimension)};
  }
}

std::vector<std::uint8_t> HnswIndex::serialize() const {
  ByteWriter writer;
  writer.number(kFormat);
  writer.number(static_cast<std::uint32_t>(search_effort_));
  const std::vector<std::uint8_t> graph = encode_hnsw_graph(graph_);
  writer.array(std::span(graph));
  return writer.take();
}

std::unique_ptr<WordIndex> HnswIndex::build(std::span<const std::uint8_t> centroids, const WordIndexOptions& options) {
  const int effort = options.hnsw_search_effort == 0 ? kDefaultHnswSearchEffort : options.hnsw_search_effort;
  return std::make_unique<HnswIndex>(
      centroids, build_hnsw_graph(centroids, {options.hnsw_links, options.hnsw_build_effort, options.seed}), effort);
}

std::unique_ptr<WordIndex> HnswIndex::load(std::span<const std::uint8_t> centroids,
                                           std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  if (reader.number<std::uint32_t>() != kFormat) throw FormatError("HNSW index: unknown format");
  const auto effort = reader.number<std::uint32_t>();
  if (effort > kMaxSearchEffort) throw FormatError("HNSW index: search effort out of range");
  const auto graph = reader.array<std::uint8_t>();
  reader.expect_end();
  const auto words = static_cast<std::uint32_t>(centroids.size() / kDescriptorDimension);
  return std::make_unique<HnswIndex>(centroids, decode_hnsw_graph(graph, words), static_cast<int>(effort));
}

}  // namespace mapweld
