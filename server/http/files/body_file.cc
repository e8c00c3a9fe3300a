#include "server/http/files/body_file.h"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

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
}

}  // namespace mapweld::server
