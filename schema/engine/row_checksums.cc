#include "schema/engine/row_checksums.h"

#include <algorithm>
#include <array>

namespace mapweld {
namespace {

constexpr std::string_view kColumn = "checksum";
constexpr const char* kRowId = "rowid";
constexpr std::array<std::string_view, 2> kReckonedByInsert = {"edges", "deleted_edges"};

std::string in_quotes(std::string_view name) { return '"' + std::string(name) + '"'; }

// `of` is OLD, NEW or empty: the row at hand.
std::string column_of(std::string_view of, std::string_view name) {
  return of.empty() ? in_quotes(name) : std::string(of) + '.' + in_quotes(name);
}

std::string checksum_of(const std::string& table, const std::vector<std::string>& columns, std::string_view of = {}) {
  std::string sql = "mapweld_checksum('" + table + "'";
  for (const std::string& column : columns) sql += ", " + column_of(of, column);
  return sql + ")";
}

// UPDATE, in a trigger, of the row that fired it.
std::string set_checksum_of_new(const ChecksummedTable& table, const std::string& value) {
  std::string where;
  const std::vector<std::string> rowid = {kRowId};
  for (const std::string& column : table.has_rowid ? rowid : table.key) {
    where += (where.empty() ? " WHERE " : " AND ") + in_quotes(column) + " = NEW." + in_quotes(column);
  }
  return "UPDATE " + in_quotes(table.name) + " SET checksum = " + value + where + "; ";
}

void drop_triggers(sqlite::Connection& connection) {
  std::string script;
  {
    sqlite::Statement trigger =
        connection.prepare("SELECT name FROM sqlite_temp_schema WHERE type = 'trigger' AND name GLOB 'checksum_*'");
    while (trigger.step()) script += "DROP TRIGGER temp." + in_quotes(trigger.text(0)) + ";";
  }
  connection.execute(script);
}

}  // namespace

std::vector<ChecksummedTable> checksummed_tables(sqlite::Connection& connection) {
  sqlite::Statement row = connection.prepare(
      "SELECT t.name, t.wr, c.name, c.pk FROM pragma_table_list t JOIN pragma_table_info(t.name, 'main') c "
      "WHERE t.schema = 'main' AND t.type = 'table' AND t.name NOT GLOB 'sqlite_*' ORDER BY t.name, c.cid");
  std::vector<ChecksummedTable> tables;
  std::vector<std::pair<std::int64_t, std::string>> key;
  bool has_checksum = false;
  const auto finish = [&] {
    if (tables.empty()) return;
    std::ranges::sort(key);
    for (auto& [place, column] : key) tables.back().key.push_back(std::move(column));
    if (key.empty()) tables.back().key = {kRowId};
    if (!has_checksum) tables.pop_back();
    key.clear();
    has_checksum = false;
  };
  std::string name;
  while (row.step()) {
    if (row.text(0) != name) {
      finish();
      name = row.text(0);
      tables.push_back({.name = name, .columns = {}, .key = {}, .has_rowid = row.integer(1) == 0});
    }
    if (row.text(2) == kColumn) {
      has_checksum = true;
      continue;
    }
    tables.back().columns.emplace_back(row.text(2));
    if (row.integer(3) > 0) key.emplace_back(row.integer(3), row.text(2));
  }
  finish();
  return tables;
}

void keep_row_checksums(sqlite::Connection& connection) {
  drop_triggers(connection);
  std::string script;
  for (const ChecksummedTable& table : checksummed_tables(connection)) {
    const std::string on = " ON main." + in_quotes(table.name) + " BEGIN ";
    const std::string inserted = checksum_of(table.name, table.columns, "NEW");
    if (std::ranges::find(kReckonedByInsert, table.name) == kReckonedByInsert.end()) {
      script += "CREATE TEMP TRIGGER " + in_quotes("checksum_inserted_" + table.name) + " AFTER INSERT" + on +
                set_checksum_of_new(table, inserted) + "END;";
    }
    std::string columns;
    for (const std::string& column : table.columns) columns += (columns.empty() ? "" : ", ") + in_quotes(column);
    const std::string updated =
        "mapweld_xor(OLD.checksum, " + checksum_of(table.name, table.columns, "OLD") + ", " + inserted + ")";
    script += "CREATE TEMP TRIGGER " + in_quotes("checksum_updated_" + table.name) + " AFTER UPDATE OF " + columns +
              on + set_checksum_of_new(table, updated) + "END;";
  }
  connection.execute(script);
}

RowChecksumMigration::RowChecksumMigration(sqlite::Connection& connection)
    : connection_(connection), before_(checksummed_tables(connection)) {
  keep_row_checksums(connection_);
}

void RowChecksumMigration::follow() {
  drop_triggers(connection_);
  for (const ChecksummedTable& table : checksummed_tables(connection_)) {
    const auto former = std::ranges::find(before_, table.name, &ChecksummedTable::name);
    std::string value = checksum_of(table.name, table.columns);
    if (former != before_.end()) {
      if (former->columns == table.columns) continue;
      value = "mapweld_xor(checksum, " + checksum_of(table.name, former->columns) + ", " + value + ")";
    }
    connection_.execute("UPDATE " + in_quotes(table.name) + " SET checksum = " + value);
  }
}

void for_each_changed_row(sqlite::Connection& connection, const ChecksummedTable& table,
                          const std::function<void(std::string_view key)>& found) {
  std::string key;
  for (const std::string& column : table.key) {
    const std::string value = "ifnull(" + in_quotes(column) + ", 'NULL')";
    key += key.empty() ? "" : " || ', ' || ";
    const bool is_alone = table.key.size() == 1 && column != kRowId;
    key += is_alone ? value : "'" + column + " ' || " + value;
  }
  sqlite::Statement row = connection.prepare("SELECT " + key + " FROM " + in_quotes(table.name) +
                                             " WHERE checksum IS NOT " + checksum_of(table.name, table.columns));
  while (row.step()) found(row.text(0));
}

}  // namespace mapweld
