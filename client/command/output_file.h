// Where a figure or an export goes: a file that appears whole or not at all, or standard output.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace mapweld::command {

// Collects bytes in a temporary file beside `path` and puts it into place with `commit`. An empty path or "-" is
// standard output. Throws std::system_error when something cannot be written; then `path` is as it was.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  void commit();

 private:
  std::filesystem::path path_;  // empty: standard output
  std::filesystem::path temporary_;
  std::ofstream file_;
  bool committed_ = false;
};

}  // namespace mapweld::command
