// A file as the answer to a request, whole or in part.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "server/http/message.h"

namespace mapweld::server {

// A file that stays readable for as long as this lives, whatever becomes of its name. Thread-safe.
class OpenFile {
 public:
  // Throws std::system_error when it cannot be opened.
  explicit OpenFile(const std::filesystem::path& file);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  std::uint64_t bytes() const { return bytes_; }
  // Appends `bytes` of it from `at`. Throws std::system_error when they cannot be read or are not there any more.
  void read(std::uint64_t at, std::size_t bytes, std::string& into) const;

 private:
  int descriptor_;
  std::uint64_t bytes_ = 0;
};

// The file, with its length: 200 with all of it, or 206 with the one range that the request asks for (RFC 9110, section
// 14); a set of ranges is answered as none. `etag` says which state of the file it is, in quotes: If-Range goes by it.
// A range that begins beyond the end: the problem range_not_satisfiable, with the length in Content-Range.
Reply file_reply(const Request& request, std::shared_ptr<const OpenFile> file, const std::string& content_type,
                 const std::string& etag);

}  // namespace mapweld::server
