#include "schema/engine/migrations.h"

#include <string>

#include "schema/engine/row_checksums.h"

namespace mapweld {

int schema_version() { return migrations().back().version; }

int migrate(sqlite::Connection& connection, std::span<const Migration> steps) {
  const int found = static_cast<int>(connection.query_integer("PRAGMA user_version"));
  const int newest = steps.empty() ? 0 : steps.back().version;
  if (found > newest) {
    throw StoreError(StoreErrorKind::kNewerVersion, "the database has schema version " + std::to_string(found) +
                                                        "; this program knows versions up to " +
                                                        std::to_string(newest) + ": install a newer Mapweld");
  }
  // Rebuilding a table drops it, which must not cascade; references are checked before each commit instead. The pragma
  // has no effect inside a transaction.
  connection.execute("PRAGMA foreign_keys = OFF");
  for (const Migration& step : steps) {
    if (step.version <= found) continue;
    sqlite::Transaction transaction(connection, sqlite::Transaction::Kind::kWrite);
    // Another process may have taken it while this one waited for its turn.
    if (connection.query_integer("PRAGMA user_version") >= step.version) continue;
    RowChecksumMigration checksums(connection);
    connection.execute(std::string(step.sql));
    checksums.follow();
    if (connection.prepare("PRAGMA foreign_key_check").step()) {
      throw StoreError(StoreErrorKind::kCorrupt,
                       "migration " + std::string(step.name) + " leaves a dangling reference");
    }
    connection.execute("PRAGMA user_version = " + std::to_string(step.version));
    transaction.commit();
  }
  connection.execute("PRAGMA foreign_keys = ON");
  return found;
}

}  // namespace mapweld
