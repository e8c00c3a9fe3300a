// The postings of a range of vertices, in memory: what a segment holds. Between appearances, tables and index.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/retrieval/postings.h"
#include "core/types.h"
#include "schema/maps/absent_vertices.h"
#include "schema/segments/segment_store.h"

namespace mapweld {

// In the shape of InvertedIndex::add_segment: words[i] has postings[offsets[i] .. offsets[i + 1]).
struct SegmentPostings {
  VertexId first{};
  std::uint32_t count = 0;
  std::vector<WordId> words;           // ascending
  std::vector<std::uint32_t> offsets;  // one a word and one at the end
  PostingList postings;                // ascending by vertex within a word

  PostingSpan of(std::size_t i) const { return PostingSpan(postings).part(offsets[i], offsets[i + 1]); }
  friend bool operator==(const SegmentPostings&, const SegmentPostings&) = default;
};

// From the appearances of the vertices [first, first + count) of a plain map, deleted ones too, so that a segment need
// not be written anew when one of them is restored; nullopt when one of them has none under this vocabulary and is not
// purged.
std::optional<SegmentPostings> invert_appearances(const Reader& db, MapId map, VocabularyId vocabulary, VertexId first,
                                                  std::uint32_t count);

// As stored. Throws StoreError kCorrupt when a block is damaged or the number of postings is not the row's.
SegmentPostings read_segment(const Reader& db, const SegmentRow& segment);

// Neighbours, ascending and without gaps, as one.
SegmentPostings concatenate(std::span<const SegmentPostings> neighbours);

// The part over the vertices [first, first + count), with `first` renumbered to `renumbered_first`.
SegmentPostings cut(const SegmentPostings& segment, VertexId first, std::uint32_t count, VertexId renumbered_first);

// What is left of it without some of its vertices, whose numbers stay unused.
SegmentPostings without(SegmentPostings segment, const VertexSet& vertices);
// The same of the postings of a word.
void remove_postings(PostingList& postings, const VertexSet& vertices);

SegmentId insert_segment(WriteTransaction& db, MapId map, VocabularyId vocabulary, const SegmentPostings& segment);

}  // namespace mapweld
