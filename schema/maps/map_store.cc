#include "schema/maps/map_store.h"

#include <algorithm>
#include <map>

#include "schema/rows.h"

namespace mapweld {
namespace {

constexpr std::string_view kColumns =
    "SELECT id, uuid, name, kind, vocabulary, parameters, labels, created_at_us, revision, vertices, edges, ignored, "
    "unconfirmed, judgements FROM maps ";

MapRow read_row(const sqlite::Statement& row) {
  MapRow map;
  map.id = row.id<MapId>(0);
  map.uuid = row.text(1);
  map.name = row.text(2);
  map.kind = row.text(3) == "merged" ? MapKind::kMerged : MapKind::kMap;
  map.vocabulary = row.id<VocabularyId>(4);
  map.parameters = row.text(5);
  map.labels = row.text(6);
  map.created_at = rows::timestamp(row, 7);
  map.revision = static_cast<std::uint64_t>(row.integer(8));
  map.vertices = static_cast<std::uint32_t>(row.integer(9));
  map.edges = static_cast<std::uint64_t>(row.integer(10));
  map.ignored = static_cast<std::uint64_t>(row.integer(11));
  map.unconfirmed = static_cast<std::uint64_t>(row.integer(12));
  map.judgements = static_cast<std::uint64_t>(row.integer(13));
  return map;
}

template <typename Key>
std::optional<MapRow> find_by(const Reader& db, std::string_view condition, const Key& key) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + std::string(condition));
  if (!row.bind(1, key).step()) return std::nullopt;
  return read_row(row);
}

MapId insert_row(WriteTransaction& db, const NewMap& map, MapKind kind) {
  db.prepare(
        "INSERT INTO maps (uuid, name, kind, vocabulary, parameters, labels, created_at_us) VALUES (?, ?, ?, ?, ?, ?, "
        "?)")
      .bind_all(map.uuid, map.name, to_string(kind), map.vocabulary, map.parameters, map.labels,
                rows::microseconds(map.created_at))
      .run();
  return MapId{db.connection().last_insert_rowid()};
}

struct NewSpan {
  MapId member{};
  std::uint32_t first_member_vertex = 0;
  std::uint32_t count = 0;
};

// Appends spans to a merged map's numbering and counts their vertices.
void append_spans(WriteTransaction& db, MapId merged, std::span<const NewSpan> spans) {
  sqlite::Statement end = db.prepare(
      "SELECT coalesce(max(span) + 1, 0), coalesce(max(first_vertex + count), 0) FROM member_spans WHERE merged = ?");
  end.bind(1, merged).step();
  std::int64_t span = end.integer(0);
  std::int64_t first = end.integer(1);
  sqlite::Statement insert = db.prepare(
      "INSERT INTO member_spans (merged, span, member, first_vertex, first_member_vertex, count) "
      "VALUES (?, ?, ?, ?, ?, ?)");
  for (const NewSpan& s : spans) {
    insert.bind_all(merged, span++, s.member, first, s.first_member_vertex, s.count).run();
    first += s.count;
  }
  if (first > UINT32_MAX) throw StoreError(StoreErrorKind::kConstraint, "a map cannot have 2^32 vertices");
  db.prepare("UPDATE maps SET vertices = ?, revision = revision + 1 WHERE id = ?").bind_all(first, merged).run();
}

}  // namespace

std::string_view to_string(MapKind kind) { return kind == MapKind::kMerged ? "merged" : "map"; }

MapId insert_map(WriteTransaction& db, const NewMap& map) { return insert_row(db, map, MapKind::kMap); }

MapId insert_merged_map(WriteTransaction& db, const NewMap& map, std::span<const MapId> members) {
  if (members.size() < 2) throw StoreError(StoreErrorKind::kConstraint, "a merged map has two members or more");
  const MapId merged = insert_row(db, map, MapKind::kMerged);
  std::vector<NewSpan> spans;
  for (const MapId member : members) {
    const auto row = find_map(db, member);
    if (!row) throw StoreError(StoreErrorKind::kConstraint, "a member of the merged map does not exist");
    if (row->vocabulary != map.vocabulary) {
      throw StoreError(StoreErrorKind::kConstraint, "member " + row->name + " has another vocabulary");
    }
    spans.push_back({member, 0, row->vertices});
  }
  append_spans(db, merged, spans);
  return merged;
}

std::uint32_t extend_merged_map(WriteTransaction& db, MapId merged) {
  std::vector<NewSpan> spans;
  std::uint32_t gained = 0;
  for (const MemberRow& member : list_members(db, merged)) {
    if (member.vertices == member.watermark) continue;
    spans.push_back({member.map, member.watermark, member.vertices - member.watermark});
    gained += spans.back().count;
  }
  if (!spans.empty()) append_spans(db, merged, spans);
  return gained;
}

std::optional<MapRow> find_map(const Reader& db, std::string_view name) { return find_by(db, "WHERE name = ?", name); }

std::optional<MapRow> find_map(const Reader& db, MapId id) { return find_by(db, "WHERE id = ?", id); }

std::optional<MapRow> find_map_by_uuid(const Reader& db, std::string_view uuid) {
  return find_by(db, "WHERE uuid = ?", uuid);
}

std::vector<MapRow> list_maps(const Reader& db, std::size_t limit, std::optional<MapId> after) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE id > ? ORDER BY id LIMIT ?");
  row.bind_all(after.value_or(MapId{0}), limit);
  std::vector<MapRow> maps;
  while (row.step()) maps.push_back(read_row(row));
  return maps;
}

std::vector<MemberRow> list_members(const Reader& db, MapId merged) {
  sqlite::Statement row = db.prepare(
      "SELECT member, name, sum(count), vertices FROM member_spans JOIN maps ON maps.id = member "
      "WHERE merged = ? GROUP BY member ORDER BY min(span)");
  row.bind(1, merged);
  std::vector<MemberRow> members;
  while (row.step()) {
    members.push_back({row.id<MapId>(0), std::string(row.text(1)), static_cast<std::uint32_t>(row.integer(2)),
                       static_cast<std::uint32_t>(row.integer(3))});
  }
  return members;
}

std::vector<MapRow> list_merged_over(const Reader& db, MapId map) {
  sqlite::Statement row =
      db.prepare(std::string(kColumns) + "WHERE id IN (SELECT merged FROM member_spans WHERE member = ?) ORDER BY id");
  row.bind(1, map);
  std::vector<MapRow> maps;
  while (row.step()) maps.push_back(read_row(row));
  return maps;
}

std::vector<MapRow> list_all_merged_over(const Reader& db, MapId map) {
  std::map<MapId, MapRow> found;
  std::vector<MapId> open = {map};
  while (!open.empty()) {
    const MapId of = open.back();
    open.pop_back();
    for (MapRow& merged : list_merged_over(db, of)) {
      const MapId id = merged.id;
      if (found.emplace(id, std::move(merged)).second) open.push_back(id);
    }
  }
  std::vector<MapRow> all;
  for (auto& [id, row] : found) all.push_back(std::move(row));
  return all;
}

bool change_map(WriteTransaction& db, MapId map, std::string_view name, std::string_view labels,
                std::string_view parameters) {
  const std::optional<MapRow> before = find_map(db, map);
  if (!before) return false;
  db.prepare("UPDATE maps SET name = ?2, labels = ?3, parameters = ?4, revision = revision + 1 WHERE id = ?1")
      .bind_all(map, name, labels, parameters)
      .run();
  if (before->name == name) return true;
  for (const MapRow& merged : list_all_merged_over(db, map)) {
    db.prepare("UPDATE maps SET revision = revision + 1 WHERE id = ?").bind(1, merged.id).run();
  }
  return true;
}

DeleteOutcome delete_map(WriteTransaction& db, MapId map) {
  if (db.prepare("SELECT 1 FROM member_spans WHERE member = ? LIMIT 1").bind(1, map).step()) {
    return DeleteOutcome::kInUse;
  }
  // Everything that a map owns goes by cascade.
  db.prepare("DELETE FROM maps WHERE id = ?").bind(1, map).run();
  return db.connection().changes() > 0 ? DeleteOutcome::kDeleted : DeleteOutcome::kNotFound;
}

}  // namespace mapweld
