#include "server/training/descriptor_file.h"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace mapweld {
namespace {

constexpr std::uint64_t kRow = kDescriptorDimension;

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path) {
  throw TrainingFileError(what + " " + path.string() + ": " + std::strerror(errno));
}

}  // namespace

DescriptorFile::DescriptorFile(const std::filesystem::path& path) : DescriptorFile(path, 0) {
  struct stat status {};
  if (fstat(file_, &status) != 0) fail("cannot read", path_);
  const auto bytes = static_cast<std::uint64_t>(status.st_size);
  if (bytes % kRow != 0) throw TrainingFileError(path_.string() + " does not hold whole descriptors of 128 bytes");
  size_ = bytes / kRow;
}

DescriptorFile::DescriptorFile(const std::filesystem::path& path, std::uint64_t descriptors)
    : path_(path), file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)), size_(descriptors) {
  if (file_ < 0) fail("cannot open", path_);
  posix_fadvise(file_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

DescriptorFile::~DescriptorFile() { close(file_); }

void DescriptorFile::read(std::uint64_t first, std::span<std::uint8_t> rows) const {
  std::size_t done = 0;
  while (done < rows.size()) {
    const ssize_t got = pread(file_, rows.data() + done, rows.size() - done, static_cast<off_t>(first * kRow + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("cannot read", path_);
    if (got == 0) throw TrainingFileError(path_.string() + " is shorter than it was");
    done += static_cast<std::size_t>(got);
  }
}

DescriptorWriter::DescriptorWriter(const std::filesystem::path& path, std::uint64_t keep)
    : path_(path), file_(open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644)), size_(keep) {
  if (file_ < 0) fail("cannot open", path_);
  struct stat status {};
  if (fstat(file_, &status) != 0) fail("cannot read", path_);
  if (static_cast<std::uint64_t>(status.st_size) < keep * kRow) {
    throw TrainingFileError(path_.string() + " is shorter than it was");
  }
  if (ftruncate(file_, static_cast<off_t>(keep * kRow)) != 0) fail("cannot cut", path_);
  if (lseek(file_, 0, SEEK_END) < 0) fail("cannot seek in", path_);
}

DescriptorWriter::~DescriptorWriter() { close(file_); }

void DescriptorWriter::append(std::span<const std::uint8_t> rows) {
  std::size_t done = 0;
  while (done < rows.size()) {
    const ssize_t put = write(file_, rows.data() + done, rows.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) fail("cannot write", path_);
    done += static_cast<std::size_t>(put);
  }
  size_ += rows.size() / kRow;
}

void DescriptorWriter::sync() {
  if (fdatasync(file_) != 0) fail("cannot write", path_);
}

}  // namespace mapweld
