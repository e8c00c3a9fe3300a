#include "tests/support/server_process.h"

#include <chrono>
#include <regex>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mapweld::testing {
namespace {

using Clock = std::chrono::steady_clock;

struct Child {
  pid_t pid = -1;
  int output = -1;
};

Child spawn(const std::vector<std::string>& command) {
  int pipe_ends[2];
  if (::pipe2(pipe_ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
  std::vector<char*> argv;
  for (const auto& argument : command) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid < 0) throw std::runtime_error("fork failed");
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // no server outlives its test
    ::dup2(pipe_ends[1], STDOUT_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(pipe_ends[1]);
  return {pid, pipe_ends[0]};
}

int exit_code(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

}  // namespace

ServerProcess::ServerProcess(const std::filesystem::path& data_folder, std::vector<std::string> extra_arguments) {
  std::vector<std::string> command = {MAPWELD_SERVER_BINARY, "serve", "--data", data_folder.string(), "--port", "0"};
  command.insert(command.end(), extra_arguments.begin(), extra_arguments.end());
  const Child child = spawn(command);
  pid_ = child.pid;
  output_ = child.output;

  static const std::regex listening(R"(http://(?:127\.0\.0\.1|0\.0\.0\.0):([0-9]+))");
  std::string said;
  const auto deadline = Clock::now() + std::chrono::seconds(60);
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd ready{output_, POLLIN, 0};
    if (left <= 0 || ::poll(&ready, 1, static_cast<int>(left)) <= 0) {
      kill();
      throw std::runtime_error("the server did not listen within 60 s; it said: " + said);
    }
    char buffer[4096];
    const auto count = ::read(output_, buffer, sizeof buffer);
    if (count <= 0) {
      const int code = wait();
      throw std::runtime_error("the server ended with " + std::to_string(code) + "; it said: " + said);
    }
    said.append(buffer, static_cast<std::size_t>(count));
    std::smatch match;
    if (said.find('\n') != std::string::npos && std::regex_search(said, match, listening)) {
      url_ = "http://127.0.0.1:" + match[1].str();
      return;
    }
  }
}

ServerProcess::~ServerProcess() {
  if (pid_ > 0) kill();
  if (output_ >= 0) ::close(output_);
}

void ServerProcess::kill() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  wait();
}

int ServerProcess::terminate(double* seconds) {
  const auto start = Clock::now();
  ::kill(pid_, SIGTERM);
  const int code = wait();
  if (seconds != nullptr) *seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return code;
}

int ServerProcess::wait() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return exit_code(status);
}

ProcessResult run_process(const std::vector<std::string>& command) {
  const Child child = spawn(command);
  ProcessResult result;
  char buffer[4096];
  for (ssize_t count; (count = ::read(child.output, buffer, sizeof buffer)) > 0;) {
    result.output.append(buffer, static_cast<std::size_t>(count));
  }
  ::close(child.output);
  int status = 0;
  while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  result.exit_code = exit_code(status);
  return result;
}

}  // namespace mapweld::testing
