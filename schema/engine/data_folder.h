// The data folder of a server: DIR/mapweld.db and the lock that makes it one server's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "schema/engine/folder_lock.h"
#include "schema/store.h"

namespace mapweld {

// PRAGMA application_id of every Mapweld database: "MWLD".
inline constexpr std::int32_t kApplicationId = 0x4D574C44;

// Whether a file is a Mapweld database of a version that this program knows. False: it is missing or empty. Throws
// StoreError: kForeignDatabase, kNewerVersion, kNoPermission, kIo.
bool check_database_file(const std::filesystem::path& file);

// Makes the folder, for its owner only (0700), when it is missing; what exists is left as it is.
void make_data_folder(const std::filesystem::path& folder);

// By this process, as who it is now.
bool may_write_in(const std::filesystem::path& folder);

struct DataFolderOptions {
  // kServe: takes the lock, creates what is missing, brings an older schema up to date.
  // kInspect: changes nothing, reads only, also beside a running server; keeps a server from starting when none runs.
  // Of a folder that may not be written it makes kServeReadOnly.
  // kServeReadOnly: changes nothing, not even what stands beside the database (but for SQLite's index of a WAL that has
  // content); a folder that may not be written will
  // do, and any number of processes have it so. No server that writes may have it: what is read stays as it is.
  enum class Access : std::uint8_t { kServe, kInspect, kServeReadOnly } access = Access::kServe;
  StoreOptions store{.reserve_bytes = std::uint64_t{16} << 20};
};

// Opens a data folder and keeps it locked for as long as it lives; when the process dies, however it does, the lock is
// free again.
//
// - A missing folder or database is created; the database appears complete or not at all.
// - What is made is its owner's only: the folder 0700, the files 0600. Files that everybody may read, as earlier
// versions
//   made them, lose that; the rights of a group stay as they are.
// - An older schema is brought up to date, one transaction a version.
// - Refused, and nothing changed: a folder in use by another process (kFolderInUse), a database of another application
// or
//   a file that is none (kForeignDatabase), of a newer version (kNewerVersion), a WAL without its database (kCorrupt),
//   no rights (kNoPermission), no space (kNoSpace). When nothing may be changed, also no database (kNotFound), an older
//   schema (kOlderVersion), and in a folder that may not be written a WAL with content (kNoPermission).
class DataFolder {
 public:
  explicit DataFolder(const std::filesystem::path& folder, const DataFolderOptions& options = {});
  ~DataFolder();
  DataFolder(const DataFolder&) = delete;
  DataFolder& operator=(const DataFolder&) = delete;

  Store& store() { return *store_; }
  const std::filesystem::path& folder() const { return folder_; }
  // Schema version of the database when it was opened, before migrations; 0: it was created now.
  int version_found() const { return version_found_; }

 private:
  using Access = DataFolderOptions::Access;
  void open_to_serve(const StoreOptions& options);
  void open_to_inspect(StoreOptions options);
  void open_read_only(StoreOptions options);
  void open_as_it_is(const StoreOptions& options);
  void refuse_without_database() const;
  void refuse_when_in_use() const;
  std::filesystem::path file() const;
  std::filesystem::path wal() const;
  std::filesystem::path lock_file() const;

  std::filesystem::path folder_;
  std::unique_ptr<FolderLock> lock_;
  std::unique_ptr<sqlite::Connection> keeper_;  // inspecting alone: clears the WAL's files away when it closes last
  std::unique_ptr<Store> store_;
  int version_found_ = 0;
};

// Puts a backup (Store::backup) into a folder that has no database yet, where it appears whole or not at all. The
// backup stays as it is. Throws StoreError: kConstraint when a database is there, kFolderInUse, kNotFound without a
// backup, kForeignDatabase, kNewerVersion, kNoSpace, ...; then nothing has changed.
void restore_backup(const std::filesystem::path& backup, const std::filesystem::path& folder);

}  // namespace mapweld
