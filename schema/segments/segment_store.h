// Tables `segments` and `posting_blocks`: the inverted index at rest.
//
// Inserting a vertex writes its appearances only. When a range of vertices fills, its postings are written as an
// immutable segment, and segments that multiply are merged into longer ones. What the segments do not cover yet is read
// from the appearances of the newest vertices. Segments hold nothing that appearances do not: they can be dropped and
// written again (docs/storage.md).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/retrieval/inverted_index.h"
#include "schema/maps/map_layout.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

struct SegmentOptions {
  std::uint32_t vertices = 512;         // a segment is written for so many vertices
  std::uint32_t fan_in = 8;             // so many neighbours of one size are merged into one
  std::uint32_t max_vertices = 65'536;  // merging stops at this size
};

struct SegmentRow {
  SegmentId id{};
  VertexId first{};
  std::uint32_t count = 0;     // vertices
  std::uint64_t postings = 0;  // one a feature
};

// The segments of a plain map, ascending; they cover [0, n) without gaps for some n.
std::vector<SegmentRow> list_segments(const Reader& db, MapId map, VocabularyId vocabulary);

struct SegmentStatistics {
  std::uint32_t written = 0;
  std::uint32_t merged = 0;    // segments that became part of a longer one
  std::uint64_t postings = 0;  // written, counting those of merged segments
};

// Writes and merges the segments that are due, of all maps and vocabularies. Reads beside the writer and takes its turn
// only to store each finished segment, so uploads go on. Call it in the background, from any thread; a map that is
// deleted meanwhile is passed over, and a segment that another thread was faster with is not stored twice. Safe to stop
// at any moment: each segment is one transaction.
SegmentStatistics write_due_segments(Store& store, const SegmentOptions& options = {});
// Of one map and vocabulary.
SegmentStatistics write_due_segments(Store& store, MapId map, VocabularyId vocabulary,
                                     const SegmentOptions& options = {});

// Drops all segments of a map; appearances answer until they are written again.
void drop_segments(WriteTransaction& db, MapId map, VocabularyId vocabulary);

// The inverted index of any map, plain or merged, in memory; equal to one built by adding every vertex's appearances in
// order, none for those that are deleted. Throws StoreError kCorrupt when a blob is damaged.
InvertedIndex load_index(const Reader& db, const MapLayout& layout, VocabularyId vocabulary);
InvertedIndex load_index(const Reader& db, MapId map, VocabularyId vocabulary);

// Votes for a map that is not in memory, straight from the segments and the newest appearances. Reads what a query asks
// for and no more. Lives no longer than its transaction and belongs to its thread.
class SegmentPostingSource final : public PostingSource {
 public:
  SegmentPostingSource(const Reader& db, const MapLayout& layout, VocabularyId vocabulary);
  ~SegmentPostingSource() override;
  SegmentPostingSource(const SegmentPostingSource&) = delete;
  SegmentPostingSource& operator=(const SegmentPostingSource&) = delete;

  void visit(WordId word, const Visitor& visitor) const override;
  std::uint32_t vertices() const override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mapweld
