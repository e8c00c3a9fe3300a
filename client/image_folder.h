// A folder of photographs, as it is uploaded: which files, in which order, read ahead of time.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace mapweld::client {

// The photographs directly inside `directory`: regular files (or links to such) that end in .jpg, .jpeg or .png in any
// case and do not begin with a dot, by name in byte order ("10.jpg" before "9.jpg": pad numbers with zeros). Throws
// std::filesystem::filesystem_error when the directory cannot be read.
std::vector<std::filesystem::path> image_files(const std::filesystem::path& directory);

// The bytes of a file. Throws std::system_error when it cannot be read.
std::string read_file(const std::filesystem::path& path);

// SHA-256 in lower-case hexadecimal.
std::string sha256_hex(std::string_view bytes);

// Media type by the first bytes: "image/jpeg", "image/png", else "application/octet-stream".
std::string_view media_type(std::string_view bytes);

// Reads files on `threads` threads, a bounded number of them ahead, and gives them out in the order they were named in,
// whatever the number of threads.
class ReadAhead {
 public:
  struct File {
    std::filesystem::path path;
    std::string bytes;
    std::optional<std::string> sha256;  // of those for which `hash` said so
    std::string error;                  // why it cannot be read; then there are no bytes
  };
  // `hash` is called from the reading threads. At most `ahead` files (1 or more) are held.
  ReadAhead(std::vector<std::filesystem::path> paths, int threads, std::size_t ahead,
            std::function<bool(const std::filesystem::path&)> hash);
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  // The next file; nothing after the last one. Waits for it to be read.
  std::optional<File> next();

 private:
  void read_files();

  const std::vector<std::filesystem::path> paths_;
  const std::function<bool(const std::filesystem::path&)> hash_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::optional<File>> slots_;  // file i waits in slot i % ahead
  std::size_t begun_ = 0;                   // files that a thread has taken up
  std::size_t given_ = 0;                   // files that next() has given out
  bool stopped_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace mapweld::client
