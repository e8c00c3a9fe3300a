// What the store throws when it cannot do what was asked. Whatever is thrown, nothing stored has changed: the
// transaction that was open is rolled back. Expected outcomes (no such map, name taken, fenced off) are values, not
// errors.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mapweld {

enum class StoreErrorKind : std::uint8_t {
  kNoSpace,          // the disk, its quota or the page limit is full; the store stays usable for reading and deleting
  kBusy,             // another process holds the database longer than the busy timeout
  kCorrupt,          // the file, or a blob in it, is damaged (checksum, magic, truncated, broken invariant)
  kForeignDatabase,  // the file belongs to another application, or is no SQLite database at all
  kNewerVersion,     // written by a newer Mapweld: its schema version, or a blob's
  kOlderVersion,     // an older Mapweld's schema, where nothing may be changed: start the server once
  kNotFound,         // there is no database
  kFolderInUse,      // another process serves this data folder
  kNoPermission,     // the folder or file cannot be read or written with this user's rights
  kConstraint,       // a row breaks a constraint of its table: a broken request of the caller, never of a user
  kNoResources,      // the process has no file descriptor or memory left for it: try again
  kGone,             // the database was removed, replaced or unmounted under the running process
  kIo,               // the operating system failed to read or write
  kInternal,         // SQL that does not compile, misuse: a defect of the program
};

// Stable word of a kind, for logs: "no_space", "folder_in_use", ...
std::string_view to_string(StoreErrorKind kind);

class StoreError : public std::runtime_error {
 public:
  StoreError(StoreErrorKind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  StoreErrorKind kind() const { return kind_; }

 private:
  StoreErrorKind kind_;
};

}  // namespace mapweld
