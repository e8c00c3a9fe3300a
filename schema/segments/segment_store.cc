#include "schema/segments/segment_store.h"

#include <algorithm>

#include "schema/blobs/appearance_blob.h"
#include "schema/maps/absent_vertices.h"
#include "schema/segments/segment_postings.h"

namespace mapweld {
namespace {

std::uint32_t covered(const std::vector<SegmentRow>& segments) {
  return segments.empty() ? 0 : to_index(segments.back().first) + segments.back().count;
}

bool same_rows(const std::vector<SegmentRow>& a, const std::vector<SegmentRow>& b) {
  return std::ranges::equal(a, b, {}, &SegmentRow::id, &SegmentRow::id);
}

// The next segment that is due: for new vertices, or in place of `replaces` shorter ones.
struct DueSegment {
  std::vector<SegmentRow> present;  // all segments, as read
  std::size_t replaces_from = 0;    // in `present`
  std::size_t replaces = 0;
  SegmentPostings postings;
};

std::optional<DueSegment> next_due(const Reader& db, MapId map, VocabularyId vocabulary,
                                   const SegmentOptions& options) {
  const auto row = find_map(db, map);
  if (!row || row->kind != MapKind::kMap) return std::nullopt;
  DueSegment due;
  due.present = list_segments(db, map, vocabulary);

  const std::uint32_t begin = covered(due.present);
  if (row->vertices - begin >= options.vertices) {
    auto postings = invert_appearances(db, map, vocabulary, VertexId{begin}, options.vertices);
    if (!postings) return std::nullopt;
    due.postings = std::move(*postings);
    return due;
  }

  const auto& segments = due.present;
  for (std::size_t i = 0; options.fan_in > 1 && i + options.fan_in <= segments.size(); ++i) {
    const auto neighbours = std::span(segments).subspan(i, options.fan_in);
    const std::uint32_t count = neighbours.front().count;
    if (std::uint64_t{count} * options.fan_in > options.max_vertices) continue;
    if (!std::ranges::all_of(neighbours, [&](const SegmentRow& s) { return s.count == count; })) continue;
    std::vector<SegmentPostings> parts;
    for (const SegmentRow& segment : neighbours) parts.push_back(read_segment(db, segment));
    due.replaces_from = i;
    due.replaces = neighbours.size();
    due.postings = concatenate(parts);
    return due;
  }
  return std::nullopt;
}

// False when the map or its segments have changed since the segment was made.
bool store_due(WriteTransaction& db, MapId map, VocabularyId vocabulary, const DueSegment& due) {
  if (!find_map(db, map) || !same_rows(list_segments(db, map, vocabulary), due.present)) return false;
  sqlite::Statement remove = db.prepare("DELETE FROM segments WHERE id = ?");
  for (std::size_t i = 0; i < due.replaces; ++i) remove.bind(1, due.present[due.replaces_from + i].id).run();
  insert_segment(db, map, vocabulary, due.postings);
  return true;
}

// Adds the vertices [first, first + count) of a plain map, read from appearances; those that are absent without
// postings.
void add_appearances(const Reader& db, MapId map, VocabularyId vocabulary, std::uint32_t first, std::uint32_t count,
                     const VertexSet& absent, InvertedIndex& index) {
  sqlite::Statement row = db.prepare(
      "SELECT vertex, bytes FROM appearances WHERE map = ? AND vertex >= ? AND vertex < ? AND vocabulary = ? "
      "ORDER BY vertex");
  const std::uint64_t end = std::uint64_t{first} + count;
  row.bind_all(map, first, end, vocabulary);
  blobs::IndexedFeatures image;
  std::uint64_t next = first;
  const auto pass_over_absent = [&] {
    for (; next < end && absent.contains(VertexId{static_cast<std::uint32_t>(next)}); ++next) index.add({}, {});
  };
  while (row.step()) {
    if (absent.contains(row.id<VertexId>(0))) continue;
    pass_over_absent();
    if (static_cast<std::uint64_t>(row.integer(0)) != next) break;
    blobs::decode_indexed(row.blob(1), image);
    index.add(image.words, image.signatures);
    ++next;
  }
  pass_over_absent();
  if (next != end) {
    throw StoreError(StoreErrorKind::kCorrupt, "map " + std::to_string(to_index(map)) + ": vertex " +
                                                   std::to_string(next) + " has no appearances");
  }
}

// The number in the map of a leaf's vertex that a span shows.
std::uint32_t renumber(const MapLayout::LeafSpan& span, std::uint32_t leaf_vertex) {
  return to_index(span.first) + (leaf_vertex - to_index(span.leaf_first));
}

}  // namespace

std::vector<SegmentRow> list_segments(const Reader& db, MapId map, VocabularyId vocabulary) {
  sqlite::Statement row = db.prepare(
      "SELECT id, first_vertex, count, postings FROM segments WHERE map = ? AND vocabulary = ? ORDER BY first_vertex");
  row.bind_all(map, vocabulary);
  std::vector<SegmentRow> segments;
  while (row.step()) {
    segments.push_back({row.id<SegmentId>(0), row.id<VertexId>(1), static_cast<std::uint32_t>(row.integer(2)),
                        static_cast<std::uint64_t>(row.integer(3))});
  }
  return segments;
}

SegmentStatistics write_due_segments(Store& store, MapId map, VocabularyId vocabulary, const SegmentOptions& options) {
  SegmentStatistics statistics;
  for (;;) {
    std::optional<DueSegment> due;
    {
      const ReadTransaction snapshot = store.read();
      due = next_due(snapshot, map, vocabulary, options);
    }
    if (!due) return statistics;
    WriteTransaction transaction = store.write();
    if (!store_due(transaction, map, vocabulary, *due)) return statistics;
    transaction.commit();
    ++statistics.written;
    statistics.merged += static_cast<std::uint32_t>(due->replaces);
    statistics.postings += due->postings.postings.size();
  }
}

SegmentStatistics write_due_segments(Store& store, const SegmentOptions& options) {
  SegmentStatistics statistics;
  std::optional<MapId> after;
  for (;;) {
    constexpr std::size_t kMapsAtATime = 100;
    const std::vector<MapRow> maps = list_maps(store.read(), kMapsAtATime, after);
    for (const MapRow& map : maps) {
      if (map.kind != MapKind::kMap) continue;
      const SegmentStatistics of_map = write_due_segments(store, map.id, map.vocabulary, options);
      statistics.written += of_map.written;
      statistics.merged += of_map.merged;
      statistics.postings += of_map.postings;
    }
    if (maps.size() < kMapsAtATime) return statistics;
    after = maps.back().id;
  }
}

void drop_segments(WriteTransaction& db, MapId map, VocabularyId vocabulary) {
  db.prepare("DELETE FROM segments WHERE map = ? AND vocabulary = ?").bind_all(map, vocabulary).run();
}

InvertedIndex load_index(const Reader& db, const MapLayout& layout, VocabularyId vocabulary) {
  InvertedIndex index;
  for (const MapLayout::LeafSpan& span : layout.leaf_spans()) {
    const std::uint32_t begin = to_index(span.leaf_first);
    const std::uint32_t end = begin + span.count;
    const VertexSet absent = absent_vertices(db, span.leaf, span.leaf_first, span.count);
    std::uint32_t next = begin;  // in the leaf
    for (const SegmentRow& row : list_segments(db, span.leaf, vocabulary)) {
      const std::uint32_t row_end = to_index(row.first) + row.count;
      if (row_end <= next || to_index(row.first) >= end) continue;
      SegmentPostings segment = without(read_segment(db, row), absent);
      const std::uint32_t stop = std::min(row_end, end);
      if (renumber(span, next) != next || next != to_index(row.first) || stop != row_end) {
        segment = cut(segment, VertexId{next}, stop - next, VertexId{renumber(span, next)});
      }
      index.add_segment(to_index(segment.first), segment.count, segment.words, segment.offsets, segment.postings);
      next = stop;
    }
    add_appearances(db, span.leaf, vocabulary, next, end - next, absent, index);
  }
  return index;
}

InvertedIndex load_index(const Reader& db, MapId map, VocabularyId vocabulary) {
  return load_index(db, load_layout(db, map), vocabulary);
}

}  // namespace mapweld
