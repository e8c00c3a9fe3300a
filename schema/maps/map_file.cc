#include "schema/maps/map_file.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "schema/engine/data_folder.h"
#include "schema/engine/free_space.h"
#include "schema/engine/migrations.h"
#include "schema/maps/edge_store.h"
#include "schema/store_check.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Statement;

[[noreturn]] void refuse(const std::string& what) {
  throw StoreError(StoreErrorKind::kCorrupt, "the file of a map is damaged: " + what);
}

// What a column gets instead of what stands there: an expression over the row, or a number.
using Instead = std::map<std::string, std::string>;

// Copies rows of a table of one database into another's, column by column: as they are, with the checksums that they
// bear, or changed and with new ones.
void copy_rows(Connection& from, Connection& to, const std::string& table, const std::string& which,
               const Instead& instead = {}) {
  std::string columns;
  std::string values;
  std::string marks;
  int count = 0;
  Statement info = from.prepare("SELECT name FROM pragma_table_info('" + table + "')");
  while (info.step()) {
    const std::string column(info.text(0));
    if (!instead.empty() && column == "checksum") continue;
    const auto replaced = instead.find(column);
    const std::string comma = count++ == 0 ? "" : ", ";
    columns += comma + column;
    values += comma + (replaced == instead.end() ? column : replaced->second);
    marks += comma + "?" + std::to_string(count);
  }
  Statement row = from.prepare("SELECT " + values + " FROM " + table + " WHERE " + which);
  if (!instead.empty()) {
    columns += ", checksum";
    marks += ", mapweld_checksum('" + table + "', " + marks + ")";
  }
  Statement copy = to.prepare("INSERT INTO " + table + " (" + columns + ") VALUES (" + marks + ")");
  while (row.step()) {
    for (int i = 0; i < count; ++i) copy.bind_column(i + 1, row, i);
    copy.run();
  }
}

std::string quoted(const std::string& text) {
  std::string literal = "'";
  for (const char c : text) literal.append(c == '\'' ? 2 : 1, c);
  return literal + "'";
}

std::string number(std::int64_t value) { return std::to_string(value); }

// How far ids of a table must move to lie beyond all that were ever given there.
std::int64_t distance(Connection& from, Connection& to, const std::string& table) {
  constexpr std::int64_t kMost = std::int64_t{1} << 40;
  const std::int64_t first = from.query_integer("SELECT coalesce(min(id), 0) FROM " + table);
  const std::int64_t last = from.query_integer("SELECT coalesce(max(id), 0) FROM " + table);
  if (first < 0 || last > kMost) refuse("numbers in " + table + " that no server gives");
  const std::int64_t given =
      to.query_integer("SELECT coalesce((SELECT seq FROM sqlite_sequence WHERE name = '" + table + "'), 0)");
  return given + 1 - first;
}

// A copy has no deleted vertices: their numbers are as those of purged ones.
void purge_deleted(Connection& from, Connection& to, const std::string& map_there, std::int64_t map_here) {
  Statement deleted = from.prepare("SELECT vertex FROM images WHERE map = " + map_there +
                                   " AND vertex IS NOT NULL AND deleted_at_us IS NOT NULL ORDER BY vertex");
  Statement purged = to.prepare(
      "INSERT INTO purged_vertices (map, vertex, checksum) VALUES (?1, ?2, mapweld_checksum('purged_vertices', ?1, "
      "?2))");
  while (deleted.step()) purged.bind_all(map_here, deleted.integer(0)).run();
}

std::string tables_of(Connection& connection) {
  std::string all;
  Statement row = connection.prepare(
      "SELECT type || ' ' || name || ' ' || tbl_name || ' ' || coalesce(sql, '') FROM sqlite_schema "
      "WHERE name NOT LIKE 'sqlite_%' ORDER BY type, name");
  while (row.step()) all.append(row.text(0)).append("\n");
  return all;
}

// A database without anything in it, of this program's schema or an earlier version of it.
void make_empty(const fs::path& file, int version = schema_version()) {
  Connection connection(file, sqlite::OpenMode::kCreate);
  migrate(connection, migrations().first(static_cast<std::size_t>(version)));
}

void remove_database(const fs::path& file) {
  std::error_code ignored;
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) fs::remove(file.string() + suffix, ignored);
}

// The tables of a version, as its migrations make them.
std::string tables_of_version(const fs::path& beside, int version) {
  fs::path empty = beside;
  empty += ".empty";
  remove_database(empty);
  make_empty(empty, version);
  std::string tables;
  {
    Connection connection(empty, sqlite::OpenMode::kReadOnly);
    tables = tables_of(connection);
  }
  remove_database(empty);
  return tables;
}

// Brings the file up to this program's schema. Its own has to be that of its version to the letter, so that nothing
// that a stranger wrote there is ever run: no triggers, views, checks or expressions but ours.
void bring_up_to_date(const fs::path& file) {
  Connection connection(file, sqlite::OpenMode::kReadWrite);
  connection.execute("PRAGMA trusted_schema = OFF");
  connection.prepare("PRAGMA journal_mode = DELETE").step();  // no files beside it
  const std::int64_t version = connection.query_integer("PRAGMA user_version");
  if (version < 1 || version > schema_version() ||
      tables_of(connection) != tables_of_version(file, static_cast<int>(version))) {
    refuse("its tables are not those of its version");
  }
  migrate(connection, migrations());
}

// What check_store would take at its word, or into memory.
void refuse_excess(Connection& file) {
  struct Bound {
    const char* what;
    const char* query;
    std::int64_t most;
  };
  constexpr std::int64_t kMiB = 1 << 20;
  constexpr Bound kBounds[] = {
      {"more than one map", "SELECT count(*) FROM maps", 1},
      {"more than one vocabulary", "SELECT count(*) FROM vocabularies", 1},
      {"a vocabulary that is too large", "SELECT coalesce(sum(length(bytes)), 0) FROM vocabulary_chunks", 512 * kMiB},
      {"a vocabulary that is too large", "SELECT coalesce(max(file_bytes), 0) FROM vocabularies", 512 * kMiB},
      {"an inverted index", "SELECT count(*) FROM segments", 0},
      {"merges", "SELECT count(*) FROM merges", 0},
      {"answers", "SELECT count(*) FROM kept_answers", 0},
      {"owners", "SELECT (SELECT count(*) FROM owned_images) + (SELECT count(*) FROM owned_merges)", 0},
      {"a camera that is too large", "SELECT coalesce(max(length(camera)), 0) FROM images", 4096},
      {"an image that is too large", "SELECT coalesce(max(length(bytes)), 0) FROM image_bytes", 64 * kMiB},
      {"appearances that are too large", "SELECT coalesce(max(length(bytes)), 0) FROM appearances", 16 * kMiB},
      {"evidence that is too large", "SELECT coalesce(max(length(evidence)), 0) FROM edges", 16 * kMiB},
      {"appearances of another vocabulary",
       "SELECT count(*) FROM appearances WHERE vocabulary NOT IN (SELECT vocabulary FROM maps)", 0},
      {"numbers that no server gives", "SELECT coalesce(max(max(revision, judgements)), 0) FROM maps",
       std::int64_t{1} << 53},
      {"doubts that nobody has",
       "SELECT count(*) FROM edges WHERE doubt IS NOT NULL AND doubt NOT IN ('unsupported', 'ambiguous')", 0},
  };
  for (const Bound& bound : kBounds) {
    if (file.query_integer(bound.query) > bound.most) refuse(std::string("it has ") + bound.what);
  }
}

}  // namespace

void export_map(const Reader& db, MapId map, const fs::path& file, const MapFileOptions& options) {
  if (fs::exists(file)) throw StoreError(StoreErrorKind::kConstraint, file.string() + " exists already");
  try {
    make_empty(file);
    Connection to(file, sqlite::OpenMode::kReadWrite);
    to.execute("PRAGMA synchronous = OFF");  // nobody rests on it before it is whole
    const std::uint64_t pages = share_of_free_bytes(file.parent_path()) / to.query_integer("PRAGMA page_size");
    to.query_integer("PRAGMA max_page_count = " + std::to_string(std::clamp<std::uint64_t>(pages, 1, UINT32_MAX - 2)));
    Connection& from = db.connection();
    const std::string id = number(to_index(map));
    const std::string its_vocabulary = "(SELECT vocabulary FROM maps WHERE id = " + id + ")";
    const std::string its_images = "(SELECT id FROM images WHERE map = " + id + " AND deleted_at_us IS NULL)";
    const std::string its_vertices = "(SELECT vertex FROM images WHERE map = " + id + " AND deleted_at_us IS NULL)";
    sqlite::Transaction transaction(to, sqlite::Transaction::Kind::kWrite);
    copy_rows(from, to, "vocabularies", "id = " + its_vocabulary);
    copy_rows(from, to, "vocabulary_chunks", "vocabulary = " + its_vocabulary + " ORDER BY chunk");
    copy_rows(from, to, "maps", "id = " + id);
    copy_rows(from, to, "map_masks", "map = " + id);
    copy_rows(from, to, "map_cameras", "map = " + id);
    copy_rows(from, to, "images", "id IN " + its_images + " ORDER BY id");
    copy_rows(from, to, "image_poses", "image IN " + its_images + " ORDER BY image");
    if (options.pixels) copy_rows(from, to, "image_bytes", "image IN " + its_images + " ORDER BY image");
    copy_rows(
        from, to, "appearances",
        "map = " + id + " AND vocabulary = " + its_vocabulary + " AND vertex IN " + its_vertices + " ORDER BY vertex");
    copy_rows(from, to, "purged_vertices", "map = " + id);
    purge_deleted(from, to, id, to_index(map));
    copy_rows(from, to, "verifiers", "id IN (SELECT verifier FROM edges WHERE map = " + id + ") ORDER BY id");
    copy_rows(from, to, "edges", "map = " + id + " ORDER BY id");
    transaction.commit();
  } catch (...) {
    remove_database(file);
    throw;
  }
}

MapFile::MapFile(const fs::path& file) {
  if (!check_database_file(file)) throw StoreError(StoreErrorKind::kForeignDatabase, "the file of a map is empty");
  bring_up_to_date(file);
  store_ = std::make_unique<Store>(file, StoreOptions{.read_only = true});
  const ReadTransaction db = store_->read();
  refuse_excess(db.connection());
  StoreCheckOptions first;
  first.max_findings = 1;
  const StoreCheckReport report = check_store(db, first);
  if (!report.findings.empty()) refuse(report.findings[0].where + ": " + report.findings[0].what);
  const std::vector<MapRow> maps = list_maps(db, 2);
  if (maps.size() != 1 || maps[0].kind != MapKind::kMap) refuse("it does not hold one map");
  map_ = maps[0];
  vocabulary_ = find_vocabulary(db, map_.vocabulary).value();
}

MapId import_map(WriteTransaction& db, MapFile& file, const std::string& name, const std::string& uuid,
                 VocabularyId vocabulary) {
  const ReadTransaction source = file.store().read();
  Connection& from = source.connection();
  Connection& to = db.connection();
  const std::int64_t map =
      to.query_integer("SELECT coalesce(max(seq), 0) + 1 FROM sqlite_sequence WHERE name = 'maps'");
  const std::string id = number(map);
  const std::string words = number(to_index(vocabulary));
  copy_rows(from, to, "maps", "TRUE",
            {{"id", id}, {"name", quoted(name)}, {"uuid", quoted(uuid)}, {"vocabulary", words}});
  copy_rows(from, to, "map_masks", "TRUE", {{"map", id}});
  copy_rows(from, to, "map_cameras", "TRUE", {{"map", id}});
  const std::string image = number(distance(from, to, "images"));
  const std::string there = "deleted_at_us IS NULL";
  copy_rows(from, to, "images", there + " ORDER BY id", {{"map", id}, {"id", "id + " + image}});
  for (const char* table : {"image_poses", "image_bytes"}) {
    copy_rows(from, to, table, "image IN (SELECT id FROM images WHERE " + there + ") ORDER BY image",
              {{"image", "image + " + image}});
  }
  copy_rows(from, to, "appearances", "vertex IN (SELECT vertex FROM images WHERE " + there + ") ORDER BY vertex",
            {{"map", id}, {"vocabulary", words}});
  copy_rows(from, to, "purged_vertices", "TRUE", {{"map", id}});
  purge_deleted(from, to, number(to_index(file.map().id)), map);
  const std::string edge = "id + " + number(distance(from, to, "edges"));
  Statement verifier = from.prepare("SELECT id, version, parameters FROM verifiers ORDER BY id");
  while (verifier.step()) {
    const VerifierId own = intern_verifier(db, verifier.text(1), verifier.text(2));
    copy_rows(from, to, "edges", "verifier = " + number(verifier.integer(0)) + " ORDER BY id",
              {{"id", edge}, {"map", id}, {"verifier", number(to_index(own))}});
  }
  return MapId{map};
}

}  // namespace mapweld
