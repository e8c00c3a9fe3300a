#include "schema/maps/purge.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "schema/answer_store.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/maps/absent_vertices.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_removal.h"
#include "schema/merges/merge_state_store.h"
#include "schema/merges/merge_store.h"
#include "schema/segments/segment_postings.h"

namespace mapweld {
namespace {

VertexSet deleted_vertices(const Reader& db, MapId map) {
  sqlite::Statement row = db.prepare(
      "SELECT vertex FROM images INDEXED BY images_deleted WHERE map = ? AND deleted_at_us IS NOT NULL ORDER BY "
      "vertex");
  row.bind(1, map);
  std::vector<VertexId> vertices;
  while (row.step()) vertices.push_back(row.id<VertexId>(0));
  return VertexSet(std::move(vertices));
}

// A checkpoint whose edges are about to go gets the verdicts of today. False where it has no such edges.
bool settle_verdicts(WriteTransaction& db, const MergeRow& merge) {
  const VertexSet absent = absent_vertices(db, load_layout(db, merge.map));
  const std::optional<ResumableState> resumable = load_resumable_state(db, merge.id, absent);
  if (!resumable || !resumable->begins_anew) return false;
  const MergeState& state = resumable->state;
  std::vector<blobs::MergeStatePart> encoded = blobs::encode_merge_state(state, std::nullopt);
  encoded.push_back(encode_absence({absent, true}));
  std::vector<CheckpointPart> parts;
  for (const blobs::MergeStatePart& part : encoded) parts.push_back({part.name, part.bytes});
  rewrite_checkpoint(db, merge.id, parts, state.edges.size());
  return true;
}

std::uint64_t remove_edges(WriteTransaction& db, MapId map, MapId plain, const VertexSet& purged) {
  const MapLayout layout = load_layout(db, map);
  const auto node = std::ranges::find(layout.nodes(), plain, &LayoutNode::map);
  sqlite::Statement earlier = db.prepare("DELETE FROM deleted_edges WHERE map = ? AND u = ?");
  sqlite::Statement later = db.prepare("DELETE FROM deleted_edges WHERE map = ? AND v = ?");
  std::uint64_t removed = 0;
  for (const VertexId vertex : purged.vertices()) {
    const std::optional<VertexId> number = node->number(vertex);
    if (!number) continue;
    for (sqlite::Statement* statement : {&earlier, &later}) {
      statement->bind_all(map, *number).run();
      removed += static_cast<std::uint64_t>(db.connection().changes());
    }
  }
  return removed;
}

std::uint64_t rewrite_segments(WriteTransaction& db, MapId map, const VertexSet& purged) {
  std::vector<VocabularyId> vocabularies;
  {
    sqlite::Statement row = db.prepare("SELECT DISTINCT vocabulary FROM segments WHERE map = ?");
    row.bind(1, map);
    while (row.step()) vocabularies.push_back(row.id<VocabularyId>(0));
  }
  std::uint64_t rewritten = 0;
  for (const VocabularyId vocabulary : vocabularies) {
    for (const SegmentRow& row : list_segments(db, map, vocabulary)) {
      const auto first = std::ranges::lower_bound(purged.vertices(), row.first);
      if (first == purged.vertices().end() || to_index(*first) - to_index(row.first) >= row.count) continue;
      const SegmentPostings left = without(read_segment(db, row), purged);
      db.prepare("DELETE FROM segments WHERE id = ?").bind(1, row.id).run();
      insert_segment(db, map, vocabulary, left);
      ++rewritten;
    }
  }
  return rewritten;
}

}  // namespace

PurgeStatistics purge_deleted(WriteTransaction& db, MapId map) {
  const VertexSet purged = deleted_vertices(db, map);
  PurgeStatistics statistics{.vertices = purged.size()};
  if (purged.empty()) return statistics;
  for (const MapRow& merged : list_all_merged_over(db, map)) {
    if (const std::optional<MergeRow> merge = find_merge_of(db, merged.id)) {
      statistics.merges += settle_verdicts(db, *merge) ? 1 : 0;
    }
    statistics.edges += remove_edges(db, merged.id, map, purged);
  }
  statistics.edges += remove_edges(db, map, map, purged);
  statistics.segments = rewrite_segments(db, map, purged);
  sqlite::Statement remember = db.prepare("INSERT INTO purged_vertices (map, vertex) VALUES (?, ?)");
  sqlite::Statement remove = db.prepare("DELETE FROM images WHERE map = ? AND vertex = ?");
  sqlite::Statement remove_likenesses = db.prepare(
      "DELETE FROM image_bytes WHERE image IN (SELECT id FROM images WHERE map = ? AND vertex IS NULL AND similar_to = "
      "?)");
  for (const VertexId vertex : purged.vertices()) {
    remember.bind_all(map, vertex).run();
    remove_likenesses.bind_all(map, vertex).run();
    remove.bind_all(map, vertex).run();
  }
  drop_answers_of(db, map);
  db.prepare("UPDATE maps SET revision = revision + 1 WHERE id = ?").bind(1, map).run();
  return statistics;
}

void rewrite_database(const std::filesystem::path& file) {
  sqlite::Connection connection(file, sqlite::OpenMode::kReadWrite);
  connection.execute("PRAGMA secure_delete = ON; PRAGMA temp_store = FILE; VACUUM");
  sqlite::Statement moved = connection.prepare("PRAGMA wal_checkpoint(TRUNCATE)");
  if (!moved.step() || moved.integer(0) != 0) {
    throw StoreError(StoreErrorKind::kBusy, "another process reads " + file.string() +
                                                ": what was deleted is still in it. Purge again when it has ended");
  }
}

}  // namespace mapweld
