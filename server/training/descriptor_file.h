// Descriptors in a file: bytes, 128 a row, nothing else. More of them than memory holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/vocabulary/trainer.h"

namespace mapweld {

// Thrown when a file cannot be read or written; says which and why.
class TrainingFileError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Reads a file of descriptors.
class DescriptorFile final : public DescriptorSource {
 public:
  // The first `descriptors` rows of the file; all of them by default. Throws TrainingFileError, also when the file is
  // shorter or not whole rows.
  explicit DescriptorFile(const std::filesystem::path& path);
  DescriptorFile(const std::filesystem::path& path, std::uint64_t descriptors);
  ~DescriptorFile() override;
  DescriptorFile(const DescriptorFile&) = delete;
  DescriptorFile& operator=(const DescriptorFile&) = delete;

  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t first, std::span<std::uint8_t> rows) const override;

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

// A range of another source.
class DescriptorRange final : public DescriptorSource {
 public:
  DescriptorRange(const DescriptorSource& source, std::uint64_t first, std::uint64_t size)
      : source_(source), first_(first), size_(size) {}
  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t first, std::span<std::uint8_t> rows) const override { source_.read(first_ + first, rows); }

 private:
  const DescriptorSource& source_;
  std::uint64_t first_;
  std::uint64_t size_;
};

// Appends to a file of descriptors; what lies beyond `keep` rows (an interrupted append) is cut off first.
class DescriptorWriter {
 public:
  DescriptorWriter(const std::filesystem::path& path, std::uint64_t keep);
  ~DescriptorWriter();
  DescriptorWriter(const DescriptorWriter&) = delete;
  DescriptorWriter& operator=(const DescriptorWriter&) = delete;

  void append(std::span<const std::uint8_t> rows);
  void sync();  // what was appended survives a power cut
  std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_;
};

}  // namespace mapweld
