// What can be proved of any database file of ours, whatever its tables mean.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "schema/engine/database.h"
#include "schema/engine/migrations.h"

namespace mapweld {

struct Finding {
  std::string where;  // table and key: "appearances: map 3, vertex 17"
  std::string what;   // what is wrong
  friend bool operator==(const Finding&, const Finding&) = default;
};

using TellFinding = std::function<void(Finding)>;

// SQLite's integrity check and foreign keys; `file` names the file in what is found. Throws StoreError when damage
// keeps SQLite from looking.
void check_integrity(sqlite::Connection& connection, const std::string& file, const TellFinding& found);

// Whether tables and indexes are those that `steps` make.
void check_schema(sqlite::Connection& connection, std::span<const Migration> steps, const std::string& file,
                  const TellFinding& found);

// That SQLite knows a last number of each table that gives them (AUTOINCREMENT), and none below a number that is there.
// Of its own table, sqlite_sequence, nobody can keep checksums: a number raised by damage is not found.
void check_numbers(sqlite::Connection& connection, const TellFinding& found);

// The checksum of every row of every table (row_checksums.h), one finding a row. Damage that keeps a table from being
// read is a finding.
void check_rows(sqlite::Connection& connection, const TellFinding& found);

}  // namespace mapweld
