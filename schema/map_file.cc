#include "schema/map_file.h"

#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "schema/data_folder.h"
#include "schema/edge_store.h"
#include "schema/migrations.h"
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
std::string moved(Connection& from, Connection& to, const std::string& table, const std::string& column) {
  constexpr std::int64_t kMost = std::int64_t{1} << 40;
  const std::int64_t first = from.query_integer("SELECT coalesce(min(id), 0) FROM " + table);
  const std::int64_t last = from.query_integer("SELECT coalesce(max(id), 0) FROM " + table);
  if (first < 0 || last > kMost) refuse("numbers in " + table + " that no server gives");
  const std::int64_t given =
      to.query_integer("SELECT coalesce((SELECT seq FROM sqlite_sequence WHERE name = '" + table + "'), 0)");
  return column + " + " + number(given + 1 - first);
}

std::string tables_of(Connection& connection) {
  std::string all;
  Statement row = connection.prepare(
      "SELECT type || ' ' || name || ' ' || tbl_name || ' ' || coalesce(sql, '') FROM sqlite_schema "
      "WHERE name NOT LIKE 'sqlite_%' ORDER BY type, name");
  while (row.step()) all.append(row.text(0)).append("\n");
  return all;
}

// A database without anything in it, of this program's schema.
void make_empty(const fs::path& file) {
  Connection connection(file, sqlite::OpenMode::kCreate);
  migrate(connection, migrations());
}

void remove_database(const fs::path& file) {
  std::error_code ignored;
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) fs::remove(file.string() + suffix, ignored);
}

// Brings the file up to this program's schema and refuses one that has other tables.
void bring_up_to_date(const fs::path& file) {
  Connection connection(file, sqlite::OpenMode::kReadWrite);
  connection.prepare("PRAGMA journal_mode = DELETE").step();  // no files beside it
  // Whatever a stranger has made run by itself does not run here.
  if (connection.query_integer("SELECT count(*) FROM sqlite_schema WHERE type IN ('trigger', 'view')") != 0) {
    refuse("it has triggers or views");
  }
  migrate(connection, migrations());
  fs::path empty = file;
  empty += ".empty";
  remove_database(empty);
  make_empty(empty);
  const std::string expected = tables_of(*std::make_unique<Connection>(empty, sqlite::OpenMode::kReadOnly));
  remove_database(empty);
  if (tables_of(connection) != expected) refuse("its tables are not those of this version");
}

}  // namespace

void export_map(const Reader& db, MapId map, const fs::path& file, const MapFileOptions& options) {
  if (fs::exists(file)) throw StoreError(StoreErrorKind::kConstraint, file.string() + " exists already");
  try {
    make_empty(file);
    Connection to(file, sqlite::OpenMode::kReadWrite);
    to.execute("PRAGMA synchronous = OFF");  // nobody rests on it before it is whole
    Connection& from = db.connection();
    const std::string id = number(to_index(map));
    const std::string its_vocabulary = "(SELECT vocabulary FROM maps WHERE id = " + id + ")";
    const std::string its_images = "(SELECT id FROM images WHERE map = " + id + ")";
    sqlite::Transaction transaction(to, sqlite::Transaction::Kind::kWrite);
    copy_rows(from, to, "vocabularies", "id = " + its_vocabulary);
    copy_rows(from, to, "vocabulary_chunks", "vocabulary = " + its_vocabulary + " ORDER BY chunk");
    copy_rows(from, to, "maps", "id = " + id);
    copy_rows(from, to, "map_masks", "map = " + id);
    copy_rows(from, to, "images", "map = " + id + " ORDER BY id");
    if (options.pixels) copy_rows(from, to, "image_bytes", "image IN " + its_images + " ORDER BY image");
    copy_rows(from, to, "appearances",
              "map = " + id + " AND vocabulary = " + its_vocabulary + " ORDER BY vertex");
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
  const std::int64_t map = to.query_integer("SELECT coalesce(max(seq), 0) + 1 FROM sqlite_sequence WHERE name = 'maps'");
  const std::string id = number(map);
  const std::string words = number(to_index(vocabulary));
  copy_rows(from, to, "maps", "TRUE",
            {{"id", id}, {"name", quoted(name)}, {"uuid", quoted(uuid)}, {"vocabulary", words}});
  copy_rows(from, to, "map_masks", "TRUE", {{"map", id}});
  copy_rows(from, to, "images", "TRUE ORDER BY id", {{"map", id}, {"id", moved(from, to, "images", "id")}});
  // The images stand already, so that the numbers given are asked for as they were before.
  const std::int64_t first = to.query_integer("SELECT coalesce(min(id), 0) FROM images WHERE map = " + id);
  const std::int64_t first_there = from.query_integer("SELECT coalesce(min(id), 0) FROM images");
  copy_rows(from, to, "image_bytes", "TRUE ORDER BY image", {{"image", "image + " + number(first - first_there)}});
  copy_rows(from, to, "appearances", "TRUE ORDER BY vertex", {{"map", id}, {"vocabulary", words}});
  const std::string edge = moved(from, to, "edges", "id");
  Statement verifier = from.prepare("SELECT id, version, parameters FROM verifiers ORDER BY id");
  while (verifier.step()) {
    const VerifierId own = intern_verifier(db, verifier.text(1), verifier.text(2));
    copy_rows(from, to, "edges", "verifier = " + number(verifier.integer(0)) + " ORDER BY id",
              {{"id", edge}, {"map", id}, {"verifier", number(to_index(own))}});
  }
  return MapId{map};
}

}  // namespace mapweld
