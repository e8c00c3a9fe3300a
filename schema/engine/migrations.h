// The schema's versions: schema/migrations/NNNN_what_changes.sql, embedded at build time, kept in PRAGMA user_version.
// A migration that has been released never changes; a change is a new file.
#pragma once

#include <span>
#include <string_view>

#include "schema/engine/database.h"

namespace mapweld {

struct Migration {
  int version = 0;        // 1, 2, ... without gaps
  std::string_view name;  // "0001_first_schema"
  std::string_view sql;
};

// The migrations of this program, ascending.
std::span<const Migration> migrations();

// The schema version that this program reads and writes.
int schema_version();

// Brings a database from its user_version up to the last of `steps`, each version in one transaction that also checks
// foreign keys and keeps the rows' checksums (row_checksums.h): a version is there whole or not at all. Throws
// kNewerVersion, and changes nothing, for a database beyond the last step; kCorrupt when a step leaves a dangling
// reference. Returns the version found.
int migrate(sqlite::Connection& connection, std::span<const Migration> steps);

}  // namespace mapweld
