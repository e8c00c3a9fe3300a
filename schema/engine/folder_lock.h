// The lock that makes a data folder one server's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace mapweld {

// Held while it lives; when the process dies, however it does, the lock is free again. The folder itself is locked, and
// then the file: whoever removes the file lets no second server in. Some network file systems lock no folders; there
// the file has to do.
class FolderLock {
 public:
  enum class Kind : std::uint8_t {
    kAlone,        // nobody else has it, in whatever way; `file` is made when it is missing, and names this process
    kWithReaders,  // shared with others of this kind; nothing is written, and there need be no `file`
  };
  // Not taken when another process has it: ask held(). Throws StoreError: kNoPermission, kNoSpace, kIo.
  FolderLock(const std::filesystem::path& file, Kind kind);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  bool held() const { return held_; }
  // The process that took it alone last, as a number; for people only: it may be gone. "": not known.
  const std::string& holder() const { return holder_; }

 private:
  void write_holder();
  void read_holder();
  void close() const;

  const int folder_;
  const int file_;  // -1: there is none
  bool held_ = false;
  std::string holder_;
};

}  // namespace mapweld
