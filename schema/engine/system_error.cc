#include "schema/engine/system_error.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

namespace mapweld {

StoreError system_error_of(int error, const std::string& doing) {
  StoreErrorKind kind = StoreErrorKind::kIo;
  if (error == ENOSPC || error == EDQUOT) kind = StoreErrorKind::kNoSpace;
  if (error == EACCES || error == EPERM || error == EROFS) kind = StoreErrorKind::kNoPermission;
  if (error == EMFILE || error == ENFILE || error == ENOMEM) kind = StoreErrorKind::kNoResources;
  return StoreError(kind, doing + ": " + std::strerror(error));
}

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) throw system_error_of(errno, "cannot open " + folder.string());
  const int result = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  if (result != 0) throw system_error_of(error, "cannot sync " + folder.string());
}

}  // namespace mapweld
