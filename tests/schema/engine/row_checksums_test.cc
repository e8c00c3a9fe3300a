// The oracle is SQL: a value is changed in the file by a connection that knows nothing of checksums, and the check has
// to find it, whatever the column means.
#include "schema/engine/row_checksums.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "schema/engine/migrations.h"
#include "schema/key_store.h"
#include "schema/store_check.h"
#include "tests/schema/every_table.h"

namespace mapweld {

void PrintTo(const Finding& finding, std::ostream* out) { *out << finding.where << ": " << finding.what; }

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::StartsWith;

// SQLite as other programs open it.
class Stranger {
 public:
  explicit Stranger(const fs::path& file) {
    if (sqlite3_open(file.c_str(), &handle_) != SQLITE_OK) throw std::runtime_error("cannot open " + file.string());
  }
  ~Stranger() { sqlite3_close(handle_); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  // Rows as text; NULL as "NULL".
  std::vector<std::vector<std::string>> rows(const std::string& sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(handle_, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) throw std::runtime_error(sql);
    std::vector<std::vector<std::string>> rows;
    int result = 0;
    while ((result = sqlite3_step(statement)) == SQLITE_ROW) {
      std::vector<std::string>& row = rows.emplace_back();
      for (int column = 0; column < sqlite3_column_count(statement); ++column) {
        const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
        row.emplace_back(text != nullptr ? text : "NULL");
      }
    }
    const std::string error = result == SQLITE_DONE ? "" : sqlite3_errmsg(handle_);
    sqlite3_finalize(statement);
    if (!error.empty()) throw std::runtime_error(sql + ": " + error);
    return rows;
  }
  void run(const std::string& sql) { rows(sql); }
  int changes() { return sqlite3_changes(handle_); }

 private:
  sqlite3* handle_ = nullptr;
};

struct Column {
  std::string table;
  std::string name;
  std::string type;
};

std::vector<Column> columns_of(const fs::path& file) {
  std::vector<Column> columns;
  for (const auto& row : Stranger(file).rows("SELECT s.name, c.name, c.type FROM sqlite_schema s JOIN "
                                             "pragma_table_info(s.name) c WHERE s.type = 'table' AND s.name NOT LIKE "
                                             "'sqlite^_%' ESCAPE '^' ORDER BY s.name, c.cid")) {
    columns.push_back({row[0], row[1], row[2]});
  }
  return columns;
}

// Another value than the one that is there, in one row of the table.
std::string change_of(const Column& column) {
  const std::string name = '"' + column.name + '"';
  std::string value = "ifnull(" + name + ", 0) + 1";
  if (column.type == "REAL") value = "ifnull(" + name + ", 0) + 0.125";
  if (column.type == "TEXT") value = "ifnull(" + name + ", '') || 'x'";
  if (column.type == "BLOB") value = "CAST(ifnull(" + name + ", x'') || x'00' AS BLOB)";
  const std::string one_row = name + " IS (SELECT max(" + name + ") FROM " + column.table + ")";
  return "UPDATE " + column.table + " SET " + name + " = " + value + " WHERE " + one_row;
}

void change(const fs::path& file, const Column& column) {
  Stranger stranger(file);
  stranger.run("PRAGMA ignore_check_constraints = ON");
  stranger.run(change_of(column));
  ASSERT_GE(stranger.changes(), 1) << "no row in " << column.table;
}

std::vector<Finding> findings_of(const fs::path& file) {
  Store store(file, {.read_only = true});
  return check_store(store.read()).findings;
}

class RowChecksumsTest : public testing::Test {
 protected:
  // A file with something in every table, and room for copies of it.
  fs::path whole() {
    const fs::path file = folder_.path() / "whole.db";
    test::EveryTable filled(store_);
    store_.store().backup(file);
    return file;
  }
  fs::path copy(const fs::path& file) {
    fs::path target = folder_.path() / "data" / "mapweld.db";
    fs::remove_all(target.parent_path());
    fs::create_directory(target.parent_path());
    fs::copy_file(file, target);
    return target;
  }
  test::TempStore store_;
  test::TempFolder folder_;
};

TEST_F(RowChecksumsTest, EveryTableBearsThemInItsLastColumn) {
  const auto columns = columns_of(store_.store().file());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i + 1 < columns.size() && columns[i + 1].table == columns[i].table) continue;
    EXPECT_EQ(columns[i].name, "checksum")
        << columns[i].table << " needs a last column `checksum`: schema/engine/row_checksums.h";
  }
}

TEST_F(RowChecksumsTest, AChangedValueIsFoundInEveryColumnOfEveryTable) {
  const fs::path file = whole();
  ASSERT_TRUE(findings_of(copy(file)).empty());
  const auto columns = columns_of(file);
  EXPECT_GE(columns.size(), 89U + 16U);
  for (const Column& column : columns) {
    const fs::path damaged = copy(file);
    change(damaged, column);
    EXPECT_THAT(findings_of(damaged), Contains(AllOf(Field(&Finding::where, StartsWith(column.table + ": ")),
                                                     Field(&Finding::what, HasSubstr("checksum")))))
        << column.table << "." << column.name;
  }
}

TEST_F(RowChecksumsTest, ARowIsToldByItsKeyOnce) {
  const fs::path damaged = copy(whole());
  Stranger(damaged).run("UPDATE appearances SET bytes = x'00' WHERE map = 2 AND vertex = 3");
  Stranger(damaged).run("UPDATE maps SET labels = '{}', uuid = replace(uuid, '-', '+') WHERE name = 'b'");
  std::vector<std::string> where;
  for (const Finding& finding : findings_of(damaged)) {
    if (finding.what.find("checksum does not match") != std::string::npos) where.push_back(finding.where);
  }
  EXPECT_EQ(where, (std::vector<std::string>{"appearances: map 2, vertex 3, vocabulary 1", "maps: 2"}));
}

TEST_F(RowChecksumsTest, DamageIsNotMadeWholeByWhatIsWrittenLater) {
  const test::EveryTable filled(store_);
  Stranger(store_.store().file()).run("UPDATE maps SET labels = '{\"robot\":\"another\"}' WHERE name = 'a'");
  test::add_vertex(store_, filled.a, filled.vocabulary, "new", {320, 240, {}});
  EXPECT_THAT(check_store(store_.read()).findings, Contains(Field(&Finding::where, "maps: 1")));
  store_.reopen();
  test::add_vertex(store_, filled.a, filled.vocabulary, "newer", {320, 240, {}});
  EXPECT_THAT(check_store(store_.read()).findings, Contains(Field(&Finding::where, "maps: 1")));
}

// They stand in files: one that changes is a format that changes.
TEST(ChecksumFunction, GivesTheSameValuesForEver) {
  sqlite::Connection connection(":memory:", sqlite::OpenMode::kReadWrite);
  EXPECT_EQ(connection.query_integer("SELECT mapweld_checksum('maps', 1, NULL, 0.5, x'00ff', 'lab')"),
            175499945888497631);
  EXPECT_EQ(connection.query_integer("SELECT mapweld_checksum('maps', '1', NULL, 0.5, x'00ff', 'lab')"),
            -414745574006458630);
  EXPECT_EQ(connection.query_integer("SELECT mapweld_xor(12, 10, -1)"), ~(12 ^ 10));
}

// What the store's own statements do not do, a later one may.
TEST_F(RowChecksumsTest, AllWaysToWriteARowKeepItsChecksum) {
  const test::EveryTable filled(store_);
  WriteTransaction db = store_.write();
  for (const char* sql : {
           "INSERT INTO meta (key, value) VALUES ('a', 'b') ON CONFLICT (key) DO UPDATE SET value = 'c'",
           "INSERT INTO meta (key, value) VALUES ('a', 'b') ON CONFLICT (key) DO UPDATE SET value = 'c'",
           "INSERT OR REPLACE INTO meta (key, value) VALUES ('a', 'd')",
           "UPDATE meta SET key = 'aa' WHERE key = 'a'",
           "INSERT INTO meta (key, value) SELECT name, '' FROM maps",
           "UPDATE edges SET log10_false_alarms = -0.0, elapsed_s = 3, confidence = 1",
           "UPDATE edges SET id = id + 1000",
           "UPDATE merges SET seed = -9223372036854775807 - 1, elapsed_s = 1e300",
           "UPDATE images SET sequence = '', camera = NULL, sequence_index = 9223372036854775807",
           "UPDATE image_bytes SET bytes = zeroblob(100000)",
       }) {
    db.prepare(sql).run();
    check_rows(db.connection(), [&](const Finding& finding) { ADD_FAILURE() << sql << ": " << finding.where; });
  }
  sqlite::Statement real = db.prepare("UPDATE edges SET log10_false_alarms = ?");
  for (const double value : {-0.0, 5e-324, 1e15, 0.1}) {
    real.bind(1, value).run();
    check_rows(db.connection(), [&](const Finding& finding) { ADD_FAILURE() << value << ": " << finding.where; });
  }
}

TEST_F(RowChecksumsTest, WhatAStatementSaysOfItselfStaysTrue) {
  WriteTransaction db = store_.write();
  db.prepare("INSERT INTO verifiers (version, parameters) VALUES ('v', '{}')").run();
  EXPECT_EQ(db.connection().last_insert_rowid(), 1);
  EXPECT_EQ(db.connection().changes(), 1);
  db.prepare("UPDATE verifiers SET version = 'w' WHERE id = 7").run();
  EXPECT_EQ(db.connection().changes(), 0);
}

TEST_F(RowChecksumsTest, RowsOfAnOlderDatabaseGetTheirs) {
  sqlite::Connection connection(folder_.path() / "old.db", sqlite::OpenMode::kCreate);
  migrate(connection, migrations().first(6));
  connection.execute(R"(
    INSERT INTO vocabularies VALUES (1, 'words', 10, 128, 'sift-u8', 'exact', zeroblob(32), 0, 0);
    INSERT INTO maps (id, uuid, name, kind, vocabulary, parameters, labels, created_at_us) VALUES
      (1, printf('%036d', 1), 'plain', 'map', 1, '{}', '{}', 0), (2, printf('%036d', 2), 'b', 'merged', 1, '{}', '{}', 0);
    INSERT INTO member_spans VALUES (2, 0, 1, 0, 0, 0))");
  migrate(connection, migrations());
  check_rows(connection, [](const Finding& finding) { ADD_FAILURE() << finding.where; });
  connection.execute("UPDATE member_spans SET first_vertex = 1");
  int found = 0;
  check_rows(connection, [&](const Finding& finding) {
    EXPECT_EQ(finding.where, "member_spans: merged 2, span 0");
    ++found;
  });
  EXPECT_EQ(found, 1);
}

TEST_F(RowChecksumsTest, LaterMigrationsKeepThemAndDoNotMakeDamageWhole) {
  sqlite::Connection connection(folder_.path() / "a.db", sqlite::OpenMode::kCreate);
  std::vector<Migration> steps = {
      {1, "0001_one",
       "CREATE TABLE a (i INTEGER PRIMARY KEY, t TEXT, checksum INTEGER NOT NULL DEFAULT 0) STRICT;"
       "INSERT INTO a (i, t) VALUES (1, 'x'), (2, 'y')"}};
  const auto found = [&] {
    std::vector<std::string> keys;
    check_rows(connection, [&](const Finding& finding) { keys.push_back(finding.where); });
    return keys;
  };
  migrate(connection, steps);
  EXPECT_EQ(found(), std::vector<std::string>());
  connection.execute("UPDATE a SET t = 'z' WHERE i = 2");  // after migrations no triggers are left
  const std::vector<std::string> damaged = {"a: 2"};
  EXPECT_EQ(found(), damaged);
  steps.push_back({2, "0002_two", "ALTER TABLE a ADD COLUMN n INTEGER NOT NULL DEFAULT 7; UPDATE a SET t = t || 'x'"});
  migrate(connection, steps);
  EXPECT_EQ(found(), damaged);
  steps.push_back(
      {3, "0003_three",
       "CREATE TABLE fresh (i INTEGER PRIMARY KEY, t TEXT, n INTEGER, o REAL, checksum INTEGER NOT NULL "
       "DEFAULT 0) STRICT;"
       "INSERT INTO fresh SELECT i, t, n, 0.5, checksum FROM a; DROP TABLE a; ALTER TABLE fresh RENAME TO a"});
  migrate(connection, steps);
  EXPECT_EQ(found(), damaged);
}

TEST_F(RowChecksumsTest, KeysBearThemToo) {
  const fs::path keys = folder_.path() / "keys.db";
  const auto findings = [&] {
    std::vector<Finding> all;
    check_keys(folder_.path(), [&](Finding finding) { all.push_back(std::move(finding)); });
    return all;
  };
  EXPECT_TRUE(findings().empty());
  EXPECT_FALSE(fs::exists(keys)) << "looking makes no file";
  {
    KeyStore store(folder_.path());
    KeyRow key;
    for (const auto& [name, role] : {std::pair{"a", "read"}, std::pair{"b", "admin"}}) {
      key.name = name;
      key.role = role;
      key.maps = "*";
      ++key.sha256[0];
      key.created_at = test::at(key.sha256[0]);
      store.add(key);
    }
    store.revoke("a", test::at(3));
    EXPECT_TRUE(findings().empty());
  }
  const fs::path kept = folder_.path() / "kept";
  fs::copy_file(keys, kept);
  EXPECT_EQ(columns_of(keys).back().name, "checksum");
  for (const Column& column : columns_of(keys)) {
    fs::copy_file(kept, keys, fs::copy_options::overwrite_existing);
    change(keys, column);
    EXPECT_THAT(findings(), Contains(AllOf(Field(&Finding::where, StartsWith("keys: ")),
                                           Field(&Finding::what, HasSubstr("checksum")))))
        << column.name;
  }
}

TEST_F(RowChecksumsTest, TheLastNumbersGivenAreNotBelowThoseThatAreThere) {
  const fs::path file = whole();
  for (const char* damage : {"UPDATE sqlite_sequence SET seq = 40 WHERE name = 'images'",
                             "UPDATE sqlite_sequence SET seq = seq << 50 WHERE name = 'images'",
                             "UPDATE sqlite_sequence SET seq = 'x' WHERE name = 'images'",
                             "UPDATE sqlite_sequence SET name = 'imagas' WHERE name = 'images'",
                             "DELETE FROM sqlite_sequence WHERE name = 'images'"}) {
    const fs::path damaged = copy(file);
    Stranger(damaged).run(damage);
    EXPECT_THAT(findings_of(damaged), Contains(Field(&Finding::where, "sqlite_sequence: images"))) << damage;
  }
}

// All rows of all tables of ours, in the order of their keys.
std::vector<std::vector<std::string>> dump(const fs::path& file) {
  Stranger stranger(file);
  std::vector<std::vector<std::string>> all;
  for (const auto& table : stranger.rows("SELECT name, (SELECT group_concat('quote(\"' || name || '\")') FROM "
                                         "pragma_table_info(s.name)) FROM sqlite_schema s WHERE type = 'table' AND "
                                         "name NOT LIKE 'sqlite^_%' ESCAPE '^' ORDER BY name")) {
    all.push_back({table[0]});
    for (auto& row : stranger.rows("SELECT " + table[1] + " FROM " + table[0] + " ORDER BY 1, 2")) {
      all.push_back(std::move(row));
    }
  }
  return all;
}

// Of the bits in use: pages are mostly empty in a small database.
std::uint64_t draw_used_bit(test::Random& random, const std::string& bytes) {
  constexpr std::size_t kAround = 16;
  while (true) {
    const std::uint64_t bit = random.below(bytes.size() * 8);
    const std::size_t first = bit / 8 < kAround ? 0 : bit / 8 - kAround;
    if (bytes.substr(first, 2 * kAround).find_first_not_of('\0') != std::string::npos) return bit;
  }
}

// MAPWELD_BIT_FLIPS says how many; the same ones each time.
TEST_F(RowChecksumsTest, AFlippedBitIsFoundOrChangesNoRow) {
  const char* asked = std::getenv("MAPWELD_BIT_FLIPS");
  const int flips = asked != nullptr ? std::atoi(asked) : 60;
  const fs::path file = whole();
  const auto rows = dump(file);
  std::ostringstream bytes_of_file;
  bytes_of_file << std::ifstream(file, std::ios::binary).rdbuf();
  test::Random random(4);
  int refused = 0;
  int found = 0;
  int harmless = 0;
  for (int i = 0; i < flips; ++i) {
    const std::uint64_t bit = draw_used_bit(random, bytes_of_file.str());
    const fs::path damaged = copy(file);
    {
      std::fstream bytes(damaged, std::ios::in | std::ios::out | std::ios::binary);
      bytes.seekg(static_cast<std::streamoff>(bit / 8));
      const int byte = bytes.get() ^ 1 << bit % 8;
      bytes.seekp(static_cast<std::streamoff>(bit / 8));
      bytes.put(static_cast<char>(byte));
    }
    try {
      DataFolderOptions inspect;
      inspect.access = DataFolderOptions::Access::kInspect;
      DataFolder data(damaged.parent_path(), inspect);
      if (!check_store(data.store().read(), {.max_findings = 1, .on_progress = {}}).findings.empty()) {
        ++found;
        continue;
      }
    } catch (const StoreError& error) {
      EXPECT_NE(error.kind(), StoreErrorKind::kInternal) << "bit " << bit << ": " << error.what();
      ++refused;
      continue;
    }
    ++harmless;
    const auto rows_now = dump(damaged);
    const auto [before, now] = std::ranges::mismatch(rows, rows_now);
    EXPECT_TRUE(before == rows.end() && now == rows_now.end())
        << "bit " << bit
        << " goes unseen: " << (now == rows_now.end() ? "a row is gone" : testing::PrintToString(*now));
  }
  EXPECT_GT(found, flips / 2);
  std::printf("%d flipped bits: %d found by the check, %d by opening, %d changed no row\n", flips, found, refused,
              harmless);
}

}  // namespace
}  // namespace mapweld
