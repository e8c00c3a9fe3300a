#include "server/http/files/body_file.h"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include "schema/engine/free_space.h"
#include "schema/engine/system_error.h"

namespace mapweld::server {

BodyFile::BodyFile(const std::filesystem::path& folder) {
  std::string name = (folder / "body-XXXXXX").string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) throw system_error_of(errno, "cannot make a file in " + folder.string());
  path_ = name;
}

BodyFile::~BodyFile() {
  ::close(descriptor_);
  ::unlink(path_.c_str());
}

void BodyFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw system_error_of(errno, "cannot write " + path_.string());
    bytes.remove_prefix(static_cast<std::size_t>(written));
    bytes_ += static_cast<std::uint64_t>(written);
  }
  constexpr std::uint64_t kBytesBetweenLooks = 16 << 20;
  if (bytes_ < looked_at_bytes_ + kBytesBetweenLooks) return;
  looked_at_bytes_ = bytes_;
  // As long as what is there already is less than what is free, it takes less than half of what was free before it.
  if (bytes_ > 2 * share_of_free_bytes(path_.parent_path())) {
    throw StoreError(StoreErrorKind::kNoSpace, "a body takes more than half of what is free");
  }
}

}  // namespace mapweld::server
