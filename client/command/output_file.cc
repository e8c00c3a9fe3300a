#include "client/command/output_file.h"

#include <cerrno>
#include <system_error>

#include <unistd.h>

#include "client/command/terminal.h"

namespace mapweld::command {
namespace fs = std::filesystem;

OutputFile::OutputFile(const std::string& path) : path_(path == "-" ? "" : path) {
  if (path_.empty()) return;
  temporary_ = path_;
  temporary_ += ".part" + std::to_string(getpid());
  errno = 0;
  file_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!file_) throw std::system_error(errno, std::generic_category(), "Cannot write " + path_.string());
}

OutputFile::~OutputFile() {
  if (path_.empty() || committed_) return;
  file_.close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void OutputFile::write(std::string_view bytes) {
  if (path_.empty()) {
    print(bytes);
    return;
  }
  errno = 0;
  if (!file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), "Cannot write " + path_.string());
  }
}

void OutputFile::commit() {
  if (path_.empty()) return;
  errno = 0;
  file_.close();
  if (!file_) {
    throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), "Cannot write " + path_.string());
  }
  fs::rename(temporary_, path_);
  committed_ = true;
}

}  // namespace mapweld::command
