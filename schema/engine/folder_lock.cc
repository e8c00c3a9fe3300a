#include "schema/engine/folder_lock.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "schema/engine/system_error.h"

namespace mapweld {
namespace {

int open_file(const std::filesystem::path& file, FolderLock::Kind kind) {
  if (kind == FolderLock::Kind::kWithReaders) return ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  return ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& file, Kind kind)
    : folder_(::open(file.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)), file_(open_file(file, kind)) {
  const bool alone = kind == Kind::kAlone;
  const int how = (alone ? LOCK_EX : LOCK_SH) | LOCK_NB;
  int error = alone && file_ < 0 ? errno : 0;
  // A folder that cannot be locked is not taken.
  const bool folder_is_taken = ::flock(folder_, how) != 0 && errno == EWOULDBLOCK;
  if (error == 0 && !folder_is_taken) {
    held_ = file_ < 0 || ::flock(file_, how) == 0;
    if (!held_ && errno != EWOULDBLOCK) error = errno;
  }
  if (error != 0) {
    close();
    throw system_error_of(error, "cannot lock " + file.string());
  }
  if (!held_) read_holder();
  if (held_ && alone) write_holder();
}

FolderLock::~FolderLock() { close(); }

void FolderLock::write_holder() {
  const std::string text = std::to_string(::getpid()) + "\n";
  if (::ftruncate(file_, 0) != 0 || ::pwrite(file_, text.data(), text.size(), 0) < 0) holder_.clear();
}

void FolderLock::read_holder() {
  std::array<char, 32> text{};
  const auto length = ::pread(file_, text.data(), text.size() - 1, 0);
  if (length > 0) holder_ = std::string(text.data(), std::strcspn(text.data(), "\n"));
}

void FolderLock::close() const {
  if (file_ >= 0) ::close(file_);
  if (folder_ >= 0) ::close(folder_);
}

}  // namespace mapweld
