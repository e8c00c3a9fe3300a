// A checksum of each row, kept in the row: a value that is changed by anything but this program does not go unseen.
//
// The last column of every table is `checksum INTEGER NOT NULL`: mapweld_checksum (checksum_function.h) of the table's
// name and of all other columns in their order. Temporary triggers keep it, on connections that write and ask for it:
// no statement has to name it, and another program, which has no such triggers, leaves rows behind whose checksum is
// wrong.
//
// Rows of `edges` come by the hundred, and an insert that fires a trigger costs half as much again: SQLite keeps what
// it needs to undo that one statement. There the INSERT itself says mapweld_checksum (edge_store.cc), and no trigger is
// fired; nor is one where they are moved to (vertex_removal.cc).
//
// An update changes a checksum by what it changes in the row, so that what was wrong before stays wrong: a damaged row
// is not made whole by counting something up in it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/engine/database.h"

namespace mapweld {

// A table that bears checksums, and of which columns.
struct ChecksummedTable {
  std::string name;
  std::vector<std::string> columns;  // without `checksum`
  std::vector<std::string> key;      // the primary key; `rowid` where there is none
  bool has_rowid = true;
};

// By name. Tables without the column are not among them.
std::vector<ChecksummedTable> checksummed_tables(sqlite::Connection& connection);

// From now on, what `connection` inserts and updates gets its checksum. To be asked anew when tables have changed.
void keep_row_checksums(sqlite::Connection& connection);

// Around a change of tables, in one transaction with it: rows keep their checksums while it runs, and have those of
// their new columns after `follow`. All rows of a table that had no `checksum` get one. A table that the change builds
// anew under its old name has the checksums that were copied into it, of the columns that it had before.
class RowChecksumMigration {
 public:
  explicit RowChecksumMigration(sqlite::Connection& connection);
  void follow();

 private:
  sqlite::Connection& connection_;
  std::vector<ChecksummedTable> before_;
};

// Tells the key ("map 3, vertex 17, vocabulary 1"; the value alone where that is one column) of each row of `table`
// whose checksum is not its own.
void for_each_changed_row(sqlite::Connection& connection, const ChecksummedTable& table,
                          const std::function<void(std::string_view key)>& found);

}  // namespace mapweld
