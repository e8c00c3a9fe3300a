#include "schema/key_store.h"

#include <array>

#include "schema/engine/data_folder.h"
#include "schema/engine/migrations.h"
#include "schema/engine/row_checksums.h"
#include "schema/rows.h"

namespace mapweld {
namespace {

constexpr std::array kVersions = {Migration{.version = 1, .name = "keys_1", .sql = R"sql(
CREATE TABLE IF NOT EXISTS keys (
  name TEXT NOT NULL,
  role TEXT NOT NULL CHECK (role IN ('read', 'write', 'operate', 'admin')),
  maps TEXT NOT NULL,
  sha256 BLOB NOT NULL UNIQUE CHECK (length(sha256) = 32),
  created_at_us INTEGER NOT NULL,
  revoked_at_us INTEGER
) STRICT;
CREATE UNIQUE INDEX IF NOT EXISTS keys_in_force ON keys (name) WHERE revoked_at_us IS NULL;
)sql"},
                                  Migration{.version = 2, .name = "keys_2", .sql = R"sql(
ALTER TABLE keys ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF;
)sql"},
                                  // A number by which the maps' database knows what a key owns. Drawn, so that a later
                                  // file of keys, beside the same maps or a copy of them, gives none of it again.
                                  Migration{.version = 3, .name = "keys_3", .sql = R"sql(
CREATE TABLE numbered (
  id INTEGER PRIMARY KEY CHECK (id > 0),
  name TEXT NOT NULL,
  role TEXT NOT NULL CHECK (role IN ('read', 'write', 'operate', 'admin')),
  maps TEXT NOT NULL,
  sha256 BLOB NOT NULL UNIQUE CHECK (length(sha256) = 32),
  created_at_us INTEGER NOT NULL,
  revoked_at_us INTEGER,
  max_images INTEGER CHECK (max_images >= 0),
  max_bytes INTEGER CHECK (max_bytes >= 0),
  max_queued_merges INTEGER CHECK (max_queued_merges >= 0),
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF
) STRICT;
INSERT INTO numbered (id, name, role, maps, sha256, created_at_us, revoked_at_us, checksum)
  SELECT random() & 0x7FFFFFFFFFFFFFFF, name, role, maps, sha256, created_at_us, revoked_at_us, checksum FROM keys;
DROP TABLE keys;
ALTER TABLE numbered RENAME TO keys;
CREATE UNIQUE INDEX keys_in_force ON keys (name) WHERE revoked_at_us IS NULL;
)sql"}};

constexpr const char* kFile = "keys.db";

StoreError foreign(const std::filesystem::path& file) {
  return StoreError(StoreErrorKind::kForeignDatabase,
                    file.string() + " is the database of another application, not Mapweld's");
}

void refuse_other_version(sqlite::Connection& connection, const std::filesystem::path& file) {
  if (connection.query_integer("PRAGMA application_id") != kKeysApplicationId) throw foreign(file);
  const std::int64_t version = connection.query_integer("PRAGMA user_version");
  if (version == kVersions.back().version) return;
  if (version > kVersions.back().version) {
    throw StoreError(StoreErrorKind::kNewerVersion,
                     file.string() + " has schema version " + std::to_string(version) + "; install a newer Mapweld");
  }
  throw StoreError(StoreErrorKind::kOlderVersion, file.string() + " has schema version " + std::to_string(version) +
                                                      ", this program " + std::to_string(kVersions.back().version) +
                                                      ": start the server once to bring it up to date");
}

std::filesystem::path file_in(const std::filesystem::path& data_folder) {
  make_data_folder(data_folder);
  return data_folder / kFile;
}

}  // namespace

KeyStore::KeyStore(const std::filesystem::path& data_folder, int busy_timeout_ms)
    : connection_(std::make_unique<sqlite::Connection>(file_in(data_folder), sqlite::OpenMode::kCreate)) {
  const std::int64_t application = connection_->query_integer("PRAGMA application_id");
  if (application != kKeysApplicationId) {
    if (application != 0 || connection_->query_integer("SELECT count(*) FROM sqlite_schema") != 0) {
      throw foreign(data_folder / kFile);
    }
    connection_->execute("PRAGMA application_id = " + std::to_string(kKeysApplicationId));
  }
  // The folder's entry of the journal is synced too: a key that was said to be revoked stays so.
  connection_->execute("PRAGMA synchronous = EXTRA");
  migrate(*connection_, kVersions);
  keep_row_checksums(*connection_);
  connection_->set_busy_timeout_ms(busy_timeout_ms);
}

KeyStore KeyStore::open_read_only(const std::filesystem::path& data_folder, int busy_timeout_ms) {
  const std::filesystem::path file = data_folder / kFile;
  if (!std::filesystem::exists(file)) return KeyStore(nullptr);
  auto connection = std::make_unique<sqlite::Connection>(file, sqlite::OpenMode::kReadOnly);
  refuse_other_version(*connection, file);
  connection->set_busy_timeout_ms(busy_timeout_ms);
  return KeyStore(std::move(connection));
}

bool KeyStore::add(const KeyRow& key) {
  sqlite::Transaction transaction(*connection_, sqlite::Transaction::Kind::kWrite);
  {
    sqlite::Statement taken = connection_->prepare("SELECT 1 FROM keys WHERE name = ? AND revoked_at_us IS NULL");
    taken.bind(1, key.name);
    if (taken.step()) return false;
  }
  connection_
      ->prepare(
          "INSERT INTO keys (id, name, role, maps, sha256, created_at_us, max_images, max_bytes, max_queued_merges) "
          "VALUES (random() & 0x7FFFFFFFFFFFFFFF, ?, ?, ?, ?, ?, ?, ?, ?)")
      .bind_all(key.name, key.role, key.maps, std::span<const std::uint8_t>(key.sha256),
                rows::microseconds(key.created_at), key.quota.images, key.quota.bytes, key.quota.queued_merges)
      .run();
  transaction.commit();
  return true;
}

bool KeyStore::revoke(const std::string& name, Timestamp at) {
  sqlite::Transaction transaction(*connection_, sqlite::Transaction::Kind::kWrite);
  connection_->prepare("UPDATE keys SET revoked_at_us = ? WHERE name = ? AND revoked_at_us IS NULL")
      .bind_all(rows::microseconds(at), name)
      .run();
  const bool found = connection_->changes() > 0;
  transaction.commit();
  return found;
}

bool KeyStore::set_quota(const std::string& name, const KeyQuota& quota) {
  sqlite::Transaction transaction(*connection_, sqlite::Transaction::Kind::kWrite);
  connection_
      ->prepare(
          "UPDATE keys SET max_images = ?, max_bytes = ?, max_queued_merges = ? WHERE name = ? AND revoked_at_us IS "
          "NULL")
      .bind_all(quota.images, quota.bytes, quota.queued_merges, name)
      .run();
  const bool found = connection_->changes() > 0;
  transaction.commit();
  return found;
}

std::vector<KeyRow> KeyStore::list() {
  if (!connection_) return {};
  sqlite::Statement row = connection_->prepare(
      "SELECT name, role, maps, sha256, created_at_us, revoked_at_us, id, max_images, max_bytes, max_queued_merges "
      "FROM "
      "keys ORDER BY name, created_at_us, revoked_at_us IS NULL");
  std::vector<KeyRow> keys;
  while (row.step()) {
    keys.push_back({.id = row.integer(6),
                    .name = std::string(row.text(0)),
                    .role = std::string(row.text(1)),
                    .maps = std::string(row.text(2)),
                    .sha256 = rows::sha256(row, 3),
                    .created_at = rows::timestamp(row, 4),
                    .revoked_at = rows::optional_timestamp(row, 5),
                    .quota = {row.optional_integer(7), row.optional_integer(8), row.optional_integer(9)}});
  }
  return keys;
}

std::int64_t KeyStore::version() { return connection_ ? connection_->query_integer("PRAGMA data_version") : 0; }

void check_keys(const std::filesystem::path& data_folder, const TellFinding& found) {
  const std::filesystem::path file = data_folder / kFile;
  if (!std::filesystem::exists(file)) return;
  std::optional<std::string> damage;
  try {
    // What a command that was killed has left half done is undone first, as by everybody who looks and may write.
    sqlite::Connection connection(
        file, may_write_in(data_folder) ? sqlite::OpenMode::kReadWrite : sqlite::OpenMode::kReadOnly);
    const sqlite::Transaction state(connection, sqlite::Transaction::Kind::kRead);
    refuse_other_version(connection, file);
    check_integrity(connection, kFile, found);
    check_schema(connection, kVersions, kFile, found);
    check_rows(connection, found);
  } catch (const StoreError& error) {
    damage = error.what();
  }
  if (damage) found({kFile, *damage});
}

}  // namespace mapweld
