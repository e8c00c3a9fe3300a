// A real `mapweld-server serve` as a child process, for tests of the whole program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace mapweld::testing {

// Starts the server on loopback, unless the arguments say otherwise, over `data_folder` with a port that the system
// picks, and waits until it listens. Killed and reaped by the destructor if it still runs. One owner, one thread.
class ServerProcess {
 public:
  // Throws std::runtime_error when the server ends, or says nothing for 60 s, before it listens.
  ServerProcess(const std::filesystem::path& data_folder, std::vector<std::string> extra_arguments = {});
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  const std::string& url() const { return url_; }
  pid_t pid() const { return pid_; }

  // SIGKILL: what a crash looks like from inside.
  void kill();
  // SIGTERM; waits for the end. Returns the exit code (128 + signal when a signal ended it); `seconds` is how long it
  // took.
  int terminate(double* seconds = nullptr);

 private:
  int wait();

  pid_t pid_ = -1;
  int output_ = -1;
  std::string url_;
};

// Runs a program and collects what it prints on standard output. Standard error passes through.
struct ProcessResult {
  int exit_code = 0;
  std::string output;
};
ProcessResult run_process(const std::vector<std::string>& command);

}  // namespace mapweld::testing
