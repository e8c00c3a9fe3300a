#include "schema/engine/file_check.h"

#include <map>
#include <optional>
#include <vector>

#include "schema/engine/row_checksums.h"

namespace mapweld {

void check_integrity(sqlite::Connection& connection, const std::string& file, const TellFinding& found) {
  sqlite::Statement integrity = connection.prepare("PRAGMA integrity_check");
  while (integrity.step()) {
    if (integrity.text(0) != "ok") found({file, std::string(integrity.text(0))});
  }
  sqlite::Statement keys = connection.prepare("PRAGMA foreign_key_check");
  while (keys.step()) {
    found({std::string(keys.text(0)) + ": row " + std::string(keys.text(1)),
           "it refers to a row of " + std::string(keys.text(2)) + " that does not exist"});
  }
}

void check_schema(sqlite::Connection& connection, std::span<const Migration> steps, const std::string& file,
                  const TellFinding& found) {
  const auto parts_of = [](sqlite::Connection& schema) {
    sqlite::Statement part = schema.prepare("SELECT type || ' ' || name, tbl_name || ': ' || sql FROM sqlite_schema");
    std::map<std::string, std::string> parts;
    while (part.step()) parts.emplace(part.text(0), part.text(1));
    return parts;
  };
  sqlite::Connection fresh(":memory:", sqlite::OpenMode::kReadWrite);
  migrate(fresh, steps);
  const auto expected = parts_of(fresh);
  const auto there = parts_of(connection);
  for (const auto& [name, sql] : expected) {
    const auto same = there.find(name);
    if (same == there.end()) {
      found({file, "there is no " + name});
    } else if (same->second != sql) {
      found({file, name + " is not as this program makes it"});
    }
  }
  for (const auto& [name, sql] : there) {
    if (!expected.contains(name)) found({file, "this program makes no " + name});
  }
}

void check_numbers(sqlite::Connection& connection, const TellFinding& found) {
  std::vector<std::string> tables;
  {
    sqlite::Statement table = connection.prepare(
        "SELECT name FROM sqlite_schema WHERE type = 'table' AND sql LIKE '%PRIMARY KEY AUTOINCREMENT%'");
    while (table.step()) tables.emplace_back(table.text(0));
  }
  std::string known = "''";
  for (const std::string& table : tables) {
    known += ", '" + table + "'";
    const std::int64_t last = connection.query_integer("SELECT ifnull(max(rowid), 0) FROM \"" + table + '"');
    // Beyond 2^53, JSON's numbers are not whole.
    sqlite::Statement row = connection.prepare(
        "SELECT count(*) = (?2 > 0 OR count(*) > 0) AND total(typeof(seq) <> 'integer' OR seq NOT BETWEEN ?2 AND "
        "9007199254740992) = 0 FROM sqlite_sequence WHERE name = ?1");
    row.bind_all(table, last).step();
    if (row.integer(0) == 0) found({"sqlite_sequence: " + table, "the last number given is not known rightly"});
  }
  const std::int64_t others = connection.query_integer(
      "SELECT count(*) FROM sqlite_sequence WHERE name IS NULL OR name NOT IN (" + known + ")");
  if (others > 0) found({"sqlite_sequence", "it counts for tables that give no numbers"});
}

void check_rows(sqlite::Connection& connection, const TellFinding& found) {
  for (const ChecksummedTable& table : checksummed_tables(connection)) {
    std::optional<std::string> damage;
    try {
      for_each_changed_row(connection, table, [&](std::string_view key) {
        found({table.name + ": " + std::string(key), "its checksum does not match: something else has changed it"});
      });
    } catch (const StoreError& error) {
      damage = error.what();
    }
    if (damage) found({table.name, *damage});
  }
}

}  // namespace mapweld
