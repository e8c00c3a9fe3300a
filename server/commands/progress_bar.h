// How far a command is, on stderr.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace mapweld::server {

// On a terminal one line that is rewritten, with a bar; in a log a line for each stage, and another every 10 s. Of one
// thread at a time.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar() { end(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(const std::string& stage, std::uint64_t done, std::uint64_t total);
  // Leaves the line as it is and begins a new one.
  void end();

 private:
  bool is_terminal_;
  std::string stage_;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace mapweld::server
