// The body of a request as a file, for what is too long for memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace mapweld::server {

// Gone with its life.
class BodyFile {
 public:
  // Makes a file of its own, for its owner only, in a folder that is there. Throws StoreError: kNoSpace, kIo, ...
  explicit BodyFile(const std::filesystem::path& folder);
  ~BodyFile();
  BodyFile(const BodyFile&) = delete;
  BodyFile& operator=(const BodyFile&) = delete;

  // Throws as the constructor; kNoSpace also when it takes more than share_of_free_bytes
  // (schema/engine/free_space.h).
  void append(std::string_view bytes);
  const std::filesystem::path& path() const { return path_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t bytes_ = 0;
  std::uint64_t looked_at_bytes_ = 0;  // when space was looked at last
};

}  // namespace mapweld::server
