#include <algorithm>
#include <optional>
#include <utility>

#include "schema/blobs/posting_blob.h"
#include "schema/segments/segment_postings.h"
#include "schema/segments/segment_store.h"

namespace mapweld {
namespace {

// A segment with the directory of its blocks, and the block that was read last: words are asked for in ascending order,
// so that the next one is often in the same block.
struct OpenSegment {
  SegmentRow row;
  std::vector<std::pair<WordId, std::int64_t>> blocks;  // first word, id; ascending
  std::optional<std::size_t> current;                   // in `blocks`
  std::vector<std::uint8_t> bytes;                      // of the current block
  std::optional<blobs::PostingBlock> block;
};

// What a leaf span shows of its leaf: segments, then the newest vertices.
struct OpenSpan {
  MapLayout::LeafSpan span;
  VertexSet absent;  // of the leaf
  std::vector<OpenSegment> segments;
  SegmentPostings newest;
};

void find_in(const SegmentPostings& segment, WordId word, PostingList& out) {
  const auto found = std::ranges::lower_bound(segment.words, word);
  if (found == segment.words.end() || *found != word) return;
  out.append(segment.of(static_cast<std::size_t>(found - segment.words.begin())));
}

void read_directory(const Reader& db, OpenSegment& segment) {
  sqlite::Statement row = db.prepare("SELECT first_word, id FROM posting_blocks WHERE segment = ? ORDER BY first_word");
  row.bind(1, segment.row.id);
  while (row.step()) segment.blocks.emplace_back(row.id<WordId>(0), row.integer(1));
}

void find_in(const Reader& db, OpenSegment& segment, WordId word, PostingList& out) {
  const auto after = std::ranges::upper_bound(segment.blocks, word, {}, &std::pair<WordId, std::int64_t>::first);
  if (after == segment.blocks.begin()) return;
  const auto at = static_cast<std::size_t>(after - segment.blocks.begin()) - 1;
  if (segment.current != at) {
    segment.current.reset();
    sqlite::Statement row = db.prepare("SELECT bytes FROM posting_blocks WHERE id = ?");
    row.bind(1, segment.blocks[at].second).step();
    segment.bytes.assign(row.blob(0).begin(), row.blob(0).end());
    segment.block.emplace(segment.bytes, segment.row.first, segment.row.count);
    segment.current = at;
  }
  segment.block->find(word, out);
}

}  // namespace

struct SegmentPostingSource::Parts {
  const Reader& db;
  std::uint32_t vertices = 0;
  std::vector<OpenSpan> spans;
  PostingList found;  // scratch
};

SegmentPostingSource::SegmentPostingSource(const Reader& db, const MapLayout& layout, VocabularyId vocabulary)
    : parts_(new Parts{db, layout.vertices(), {}, {}}) {
  for (const MapLayout::LeafSpan& span : layout.leaf_spans()) {
    OpenSpan& open = parts_->spans.emplace_back();
    open.span = span;
    open.absent = absent_vertices(db, span.leaf, span.leaf_first, span.count);
    const std::uint32_t begin = to_index(span.leaf_first);
    const std::uint32_t end = begin + span.count;
    std::uint32_t next = begin;
    for (const SegmentRow& row : list_segments(db, span.leaf, vocabulary)) {
      const std::uint32_t row_end = to_index(row.first) + row.count;
      if (row_end <= begin || to_index(row.first) >= end) continue;
      read_directory(db, open.segments.emplace_back(OpenSegment{row, {}, {}, {}, {}}));
      next = std::min(row_end, end);
    }
    auto newest = invert_appearances(db, span.leaf, vocabulary, VertexId{next}, end - next);
    if (!newest) {
      throw StoreError(StoreErrorKind::kCorrupt, "map " + std::to_string(to_index(span.leaf)) +
                                                     " has a vertex without appearances beyond " +
                                                     std::to_string(next));
    }
    open.newest = std::move(*newest);
  }
}

SegmentPostingSource::~SegmentPostingSource() = default;

void SegmentPostingSource::visit(WordId word, const Visitor& visitor) const {
  for (OpenSpan& open : parts_->spans) {
    PostingList& found = parts_->found;
    found.clear();
    for (OpenSegment& segment : open.segments) find_in(parts_->db, segment, word, found);
    find_in(open.newest, word, found);
    remove_postings(found, open.absent);
    // Segments may reach beyond the span at both its ends.
    const VertexId first = open.span.leaf_first, end{to_index(first) + open.span.count};
    const PostingSpan part = PostingSpan(found).between(first, end);
    if (!part.empty()) visitor({part, to_index(open.span.first) - to_index(first)});
  }
}

std::uint32_t SegmentPostingSource::vertices() const { return parts_->vertices; }

}  // namespace mapweld
