#include "schema/engine/data_folder.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/engine/folder_lock.h"
#include "schema/engine/migrations.h"
#include "schema/engine/system_error.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDatabaseFile = "mapweld.db";
constexpr const char* kLockFile = "mapweld.lock";

std::uint32_t big_endian(const std::array<unsigned char, 100>& header, std::size_t at) {
  return std::uint32_t{header[at]} << 24 | std::uint32_t{header[at + 1]} << 16 | std::uint32_t{header[at + 2]} << 8 |
         header[at + 3];
}

void take_from_others(const fs::path& file) {
  std::error_code not_ours;  // then its owner sees to it
  fs::permissions(file, fs::perms::others_all, fs::perm_options::remove, not_ours);
}

// The database appears under its name when it is complete.
void create_database(const fs::path& file) {
  fs::path fresh = file;
  fresh += ".new";
  fs::path journal = fresh;
  journal += "-journal";
  std::error_code ignored;
  fs::remove(fresh, ignored);
  fs::remove(journal, ignored);
  try {
    sqlite::Connection connection(fresh, sqlite::OpenMode::kCreate);
    migrate(connection, migrations());
  } catch (...) {
    fs::remove(fresh, ignored);
    fs::remove(journal, ignored);
    throw;
  }
  std::error_code error;
  fs::rename(fresh, file, error);
  if (error) throw system_error_of(error.value(), "cannot create " + file.string());
  sync_folder(file.parent_path());
}

}  // namespace

// Looks at the file's header without SQLite, which might repair, lock or leave files beside a database that is not ours
// (https://www.sqlite.org/fileformat.html, "The Database Header"). False: there is no database yet.
bool check_database_file(const fs::path& file) {
  std::error_code error;
  const auto bytes = fs::file_size(file, error);
  if (error == std::errc::no_such_file_or_directory) return false;
  if (error) throw system_error_of(error.value(), "cannot read " + file.string());
  if (bytes == 0) return false;

  std::array<unsigned char, 100> header{};
  std::ifstream in(file, std::ios::binary);
  if (!in) throw StoreError(StoreErrorKind::kNoPermission, "cannot read " + file.string());
  in.read(reinterpret_cast<char*>(header.data()), static_cast<std::streamsize>(header.size()));
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  if (in.gcount() != static_cast<std::streamsize>(header.size()) ||
      std::memcmp(header.data(), kMagic.data(), kMagic.size()) != 0) {
    throw StoreError(StoreErrorKind::kForeignDatabase, file.string() + " is not an SQLite database");
  }
  constexpr std::size_t kUserVersionAt = 60;
  constexpr std::size_t kApplicationIdAt = 68;
  if (big_endian(header, kApplicationIdAt) != static_cast<std::uint32_t>(kApplicationId)) {
    throw StoreError(StoreErrorKind::kForeignDatabase,
                     file.string() + " is the database of another application, not Mapweld's");
  }
  const auto version = static_cast<int>(big_endian(header, kUserVersionAt));
  if (version > schema_version()) {
    throw StoreError(StoreErrorKind::kNewerVersion, file.string() + " has schema version " + std::to_string(version) +
                                                        "; this program knows versions up to " +
                                                        std::to_string(schema_version()) + ": install a newer Mapweld");
  }
  return true;
}

bool may_write_in(const fs::path& folder) { return ::faccessat(AT_FDCWD, folder.c_str(), W_OK, AT_EACCESS) == 0; }

void make_data_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return;
  fs::path path = fs::absolute(folder);
  if (!path.has_filename()) path = path.parent_path();  // "data/"
  fs::create_directories(path.parent_path(), error);
  if (!error && ::mkdir(path.c_str(), 0700) != 0 && !fs::is_directory(path)) {
    error.assign(errno, std::generic_category());
  }
  if (error) throw system_error_of(error.value(), "cannot create the data folder " + folder.string());
}

DataFolder::DataFolder(const fs::path& folder, const DataFolderOptions& options) : folder_(folder) {
  switch (options.access) {
    case Access::kServe:
      open_to_serve(options.store);
      break;
    case Access::kInspect:
      may_write_in(folder_) ? open_to_inspect(options.store) : open_read_only(options.store);
      break;
    case Access::kServeReadOnly:
      open_read_only(options.store);
      break;
  }
}

void DataFolder::open_to_serve(const StoreOptions& options) {
  // Before anything is made in the folder: a foreign database stays as it is, without even a lock beside it.
  check_database_file(file());
  make_data_folder(folder_);
  lock_ = std::make_unique<FolderLock>(lock_file(), FolderLock::Kind::kAlone);
  refuse_when_in_use();

  const bool exists = check_database_file(file());
  if (!exists && fs::exists(wal())) {
    throw StoreError(StoreErrorKind::kCorrupt, wal().string() + " stands without its database " + file().string() +
                                                   ": put the database back, or remove the WAL to begin anew");
  }
  if (!exists) create_database(file());
  for (const fs::path& own : {file(), wal(), folder_ / (std::string(kDatabaseFile) + "-shm"), lock_file()})
    take_from_others(own);
  {
    sqlite::Connection connection(file(), sqlite::OpenMode::kReadWrite);
    version_found_ = migrate(connection, migrations());
    if (!exists) version_found_ = 0;
  }
  store_ = std::make_unique<Store>(file(), options);
}

void DataFolder::open_to_inspect(StoreOptions options) {
  refuse_without_database();
  lock_ = std::make_unique<FolderLock>(lock_file(), FolderLock::Kind::kAlone);
  if (lock_->held()) keeper_ = std::make_unique<sqlite::Connection>(file(), sqlite::OpenMode::kReadWrite);
  options.read_only = true;
  open_as_it_is(options);
}

void DataFolder::open_read_only(StoreOptions options) {
  refuse_without_database();
  lock_ = std::make_unique<FolderLock>(lock_file(), FolderLock::Kind::kWithReaders);
  refuse_when_in_use();
  options.read_only = true;
  std::error_code none;
  options.immutable = fs::file_size(wal(), none) == 0 || none;
  if (!options.immutable && !may_write_in(folder_)) {
    throw StoreError(StoreErrorKind::kNoPermission,
                     folder_.string() + " cannot be written, and " + wal().string() +
                         " has changes that are not in the database yet: serve a backup, or a folder whose server was "
                         "stopped");
  }
  open_as_it_is(options);
}

void DataFolder::open_as_it_is(const StoreOptions& options) {
  {
    sqlite::Connection connection(file(),
                                  options.immutable ? sqlite::OpenMode::kImmutable : sqlite::OpenMode::kReadOnly);
    version_found_ = static_cast<int>(connection.query_integer("PRAGMA user_version"));
  }
  if (version_found_ < schema_version()) {
    throw StoreError(StoreErrorKind::kOlderVersion,
                     file().string() + " has schema version " + std::to_string(version_found_) + ", this program " +
                         std::to_string(schema_version()) + ": start the server once to bring it up to date");
  }
  store_ = std::make_unique<Store>(file(), options);
}

void DataFolder::refuse_without_database() const {
  if (check_database_file(file())) return;
  throw StoreError(StoreErrorKind::kNotFound, "there is no database in " + folder_.string());
}

void DataFolder::refuse_when_in_use() const {
  if (lock_->held()) return;
  const std::string holder = lock_->holder().empty() ? "" : " (process " + lock_->holder() + ")";
  throw StoreError(StoreErrorKind::kFolderInUse, "the data folder " + folder_.string() +
                                                     " is in use by another server" + holder +
                                                     "; stop it or choose another folder");
}

fs::path DataFolder::file() const { return folder_ / kDatabaseFile; }
fs::path DataFolder::wal() const { return folder_ / (std::string(kDatabaseFile) + "-wal"); }
fs::path DataFolder::lock_file() const { return folder_ / kLockFile; }

DataFolder::~DataFolder() = default;

void restore_backup(const fs::path& backup, const fs::path& folder) {
  if (!check_database_file(backup))
    throw StoreError(StoreErrorKind::kNotFound, "there is no backup " + backup.string());
  make_data_folder(folder);
  std::error_code error;
  const FolderLock lock(folder / kLockFile, FolderLock::Kind::kAlone);
  if (!lock.held()) throw StoreError(StoreErrorKind::kFolderInUse, folder.string() + " is in use by a server");
  const fs::path file = folder / kDatabaseFile;
  for (const fs::path& there : {file, fs::path(file.string() + "-wal")}) {
    if (fs::exists(there)) {
      throw StoreError(StoreErrorKind::kConstraint, there.string() + " is there already: restore into an empty folder");
    }
  }
  const fs::path fresh = file.string() + ".new";
  fs::copy_file(backup, fresh, fs::copy_options::overwrite_existing, error);
  if (!error) {
    const int descriptor = ::open(fresh.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0 || ::fchmod(descriptor, 0600) != 0 || ::fsync(descriptor) != 0) {
      error = std::error_code(errno, std::generic_category());
    }
    if (descriptor >= 0) ::close(descriptor);
  }
  if (!error) fs::rename(fresh, file, error);
  if (error) {
    std::error_code ignored;
    fs::remove(fresh, ignored);
    throw system_error_of(error.value(), "cannot restore into " + folder.string());
  }
  sync_folder(folder);
}

}  // namespace mapweld
