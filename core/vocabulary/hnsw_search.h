// Searches for the nearest word in an HNSW graph, one query after the other (Malkov & Yashunin 2018, algorithms 2 and
// 5).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/vocabulary/distance.h"
#include "core/vocabulary/hnsw_layout.h"

namespace mapweld {

// The scratch of one thread's queries; refers to the layout and the centroids. `Word`: what the lowest level's links
// are stored in.
template <typename Word>
class HnswSearch {
 public:
  HnswSearch(const HnswLayout& layout, const HnswLowestLevel<Word>& lowest, std::span<const std::uint8_t> centroids,
             std::size_t effort)
      : layout_(layout),
        lowest_(lowest),
        centroids_(centroids.data()),
        kernel_(distance_kernel()),
        seen_by_(layout.words),
        beam_(effort) {
    std::size_t most = lowest.stride();
    for (const HnswUpperLevel& level : layout.upper) {
      for (std::size_t i = 0; i < level.words.size(); ++i) {
        most = std::max<std::size_t>(most, level.offsets[i + 1] - level.offsets[i]);
      }
    }
    fresh_.resize(most + 1);
    distances_.resize(most + 1);
  }

  std::uint32_t nearest(const std::uint8_t* query) {
    const auto [start, distance] = descend(query);
    return search_lowest(query, start, distance);
  }

 private:
  // A word and its distance in one number: sorted by distance, equally near words by their number. The lowest bit tells
  // whether the word's neighbours were looked at.
  using Seen = std::uint64_t;
  static constexpr Seen kExpanded = 1;
  static constexpr Seen make_seen(SquaredDistance distance, std::uint32_t word) {
    return Seen{distance} << 33 | Seen{word} << 1;
  }
  static constexpr std::uint32_t word_of(Seen seen) { return static_cast<std::uint32_t>((seen >> 1) & 0xFFFFFFFFu); }

  const std::uint8_t* row(std::uint32_t word) const { return centroids_ + std::size_t{word} * kDescriptorDimension; }
  void prefetch_row(std::uint32_t word) const {
    __builtin_prefetch(row(word));
    __builtin_prefetch(row(word) + 64);
  }

  // On each level above the lowest, moves to the nearest neighbour until none is nearer.
  std::pair<std::uint32_t, SquaredDistance> descend(const std::uint8_t* query) {
    std::uint32_t at = layout_.entry;
    if (layout_.upper.empty()) return {at, kernel_.pair(query, row(at))};
    Seen best = make_seen(kernel_.pair(query, row(layout_.upper.back().words[at])), layout_.upper.back().words[at]);
    for (std::size_t i = layout_.upper.size(); i-- > 0;) {
      const HnswUpperLevel& level = layout_.upper[i];
      for (bool moved = true; moved;) {
        moved = false;
        const std::uint32_t* links = level.links.data() + level.offsets[at];
        const std::size_t count = level.offsets[at + 1] - level.offsets[at];
        for (std::size_t k = 0; k < count; ++k) {
          fresh_[k] = level.words[links[k]];
          prefetch_row(fresh_[k]);
        }
        kernel_.gather(query, centroids_, fresh_.data(), count, distances_.data());
        for (std::size_t k = 0; k < count; ++k) {
          const Seen seen = make_seen(distances_[k], fresh_[k]);
          if (seen >= best) continue;
          best = seen;
          at = links[k];
          moved = true;
        }
      }
      at = level.below[at];
    }
    return {at, static_cast<SquaredDistance>(best >> 33)};
  }

  // On the lowest level, looks at the neighbours of the nearest word not yet looked at, until the beam holds no such.
  std::uint32_t search_lowest(const std::uint8_t* query, std::uint32_t start, SquaredDistance distance) {
    begin_query();
    seen_by_[start] = query_number_;
    beam_[0] = make_seen(distance, start);
    std::size_t size = 1;
    for (std::size_t at = 0; at < size;) {
      if ((beam_[at] & kExpanded) != 0) {
        ++at;
        continue;
      }
      beam_[at] |= kExpanded;
      const std::size_t count = collect_fresh(word_of(beam_[at]));
      kernel_.gather(query, centroids_, fresh_.data(), count, distances_.data());
      ++at;
      for (std::size_t k = 0; k < count; ++k) {
        const Seen seen = make_seen(distances_[k], fresh_[k]);
        if (size == beam_.size() && seen > beam_[size - 1]) continue;
        at = std::min(at, insert(seen, size));
      }
    }
    return word_of(beam_[0]);
  }

  // The links of `word` that this query has not met, into fresh_. Half of them are, unpredictably: no branch.
  std::size_t collect_fresh(std::uint32_t word) {
    const Word* links = lowest_.links(word);
    const std::size_t stride = lowest_.stride();
    std::uint32_t* const fresh = fresh_.data();
    std::uint16_t* const seen_by = seen_by_.data();
    const std::uint16_t query = query_number_;
    std::size_t count = 0;
    for (std::size_t k = 0; k < stride; ++k) {
      const std::uint32_t link = links[k];
      fresh[count] = link;
      count += seen_by[link] != query;
      seen_by[link] = query;
    }
    for (std::size_t k = 0; k < count; ++k) prefetch_row(fresh[k]);
    return count;
  }

  // Inserts into the sorted beam, dropping its worst when full; says where.
  std::size_t insert(Seen seen, std::size_t& size) {
    std::size_t place = size < beam_.size() ? size++ : size - 1;
    for (; place > 0 && beam_[place - 1] > seen; --place) beam_[place] = beam_[place - 1];
    beam_[place] = seen;
    __builtin_prefetch(lowest_.links(word_of(seen)));
    return place;
  }

  void begin_query() {
    if (++query_number_ == 0) {
      std::fill(seen_by_.begin(), seen_by_.end(), std::uint16_t{0});
      query_number_ = 1;
    }
  }

  const HnswLayout& layout_;
  const HnswLowestLevel<Word>& lowest_;
  const std::uint8_t* centroids_;
  const DistanceKernel& kernel_;
  std::vector<std::uint16_t> seen_by_;  // by word: the number of the query that met it last
  std::uint16_t query_number_ = 0;
  std::vector<Seen> beam_;            // ascending, up to its current size
  std::vector<std::uint32_t> fresh_;  // one more than links, for the branchless write
  std::vector<SquaredDistance> distances_;
};

}  // namespace mapweld
