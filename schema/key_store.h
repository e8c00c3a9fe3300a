// The keys of a server: DIR/keys.db, a small database of its own beside the maps.
//
// It is apart because it has two writers: a command makes and revokes keys while a server runs, and of the maps'
// database no other process may write (store.h). It is not in WAL mode, so that what one process commits the next look
// of another sees; and a copy of the maps carries no keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/engine/database.h"
#include "schema/engine/file_check.h"
#include "schema/store_types.h"

namespace mapweld {

// PRAGMA application_id: "MWLK".
inline constexpr std::int32_t kKeysApplicationId = 0x4D574C4B;

// The most that a key may have; absent: no bound. Each at least 0.
struct KeyQuota {
  std::optional<std::int64_t> images = {};
  std::optional<std::int64_t> bytes = {};
  std::optional<std::int64_t> queued_merges = {};
  bool bounds_images() const { return images || bytes; }
  friend bool operator==(const KeyQuota&, const KeyQuota&) = default;
};

struct KeyRow {
  std::int64_t id = 0;  // above 0, drawn by add(): no other key has it, in whatever file
  std::string name;     // unique among the keys that are not revoked
  std::string role;     // read, write, operate, admin
  std::string maps;     // pattern of map names
  Sha256 sha256{};      // of the key; the key itself is nowhere
  Timestamp created_at{};
  std::optional<Timestamp> revoked_at;
  KeyQuota quota;
};

// Belongs to one thread at a time. Throws StoreError.
class KeyStore {
 public:
  // Opens the keys of a data folder; the folder and the file are made, for their owner only, when they are missing.
  // kForeignDatabase, kNewerVersion: as a DataFolder. `busy_timeout_ms`: how long to wait for another process (kBusy).
  explicit KeyStore(const std::filesystem::path& data_folder, int busy_timeout_ms = 5'000);
  // The same of keys that are only looked at; nothing is made, and without a file there are none. kOlderVersion as
  // well.
  static KeyStore open_read_only(const std::filesystem::path& data_folder, int busy_timeout_ms);

  // False, and nothing stored, when a key of this name is in force. The hash must be another one than any before.
  bool add(const KeyRow& key);
  // From now on the key opens nothing; its row stays. False when no key of this name is in force.
  bool revoke(const std::string& name, Timestamp at);
  // Another quota for the key of this name that is in force. False when there is none.
  bool set_quota(const std::string& name, const KeyQuota& quota);
  // Whether there is a file; else it was opened read-only.
  bool exists() const { return connection_ != nullptr; }
  // By name, then by time; revoked ones as well.
  std::vector<KeyRow> list();
  // Another number than before when somebody else has changed the keys since.
  std::int64_t version();

 private:
  explicit KeyStore(std::unique_ptr<sqlite::Connection> connection) : connection_(std::move(connection)) {}

  std::unique_ptr<sqlite::Connection> connection_;  // null: opened read-only, and there is no file
};

// Looks whether the keys of a data folder are whole, also beside whoever uses them; nothing when there are none. Damage
// is a finding, never an exception, and so is another version than this program's.
void check_keys(const std::filesystem::path& data_folder, const TellFinding& found);

}  // namespace mapweld
