// A command of mapweld-server within the test: what it prints and how it ends.
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

namespace mapweld::test {

struct Ran {
  int exit_code = 0;
  std::string output;
  std::string errors;
};

// `add` adds the subcommand, as server/commands/*.h do; `line` is parsed as a shell would give it.
inline Ran run_command(void (*add)(CLI::App&), const std::string& line) {
  CLI::App app;
  add(app);
  Ran ran;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  try {
    app.parse(line);
  } catch (const CLI::RuntimeError& error) {
    ran.exit_code = error.get_exit_code();
  }
  ran.output = ::testing::internal::GetCapturedStdout();
  ran.errors = ::testing::internal::GetCapturedStderr();
  return ran;
}

}  // namespace mapweld::test
