// The `mapweld` command, ended as a program, beside a fake server and in a folder of its own.
#pragma once

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "client/image_folder.h"
#include "tests/client/fake_server.h"
#include "tests/client/temporary_folder.h"

namespace mapweld::testing {

struct Ended {
  int code = -1;
  std::string out;
  std::string err;
};

struct CommandFixture : ::testing::Test {
  FakeServer server;
  TemporaryFolder folder;

  // `arguments` as a shell would take them.
  Ended run(const std::string& arguments, const std::string& environment = "") const {
    const std::string out = (folder.path() / "out.txt").string();
    const std::string err = (folder.path() / "err.txt").string();
    const std::string command = "env -u MAPWELD_SERVER -u MAPWELD_KEY " + environment + " '" MAPWELD_BINARY "' " +
                                arguments + " >'" + out + "' 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, client::read_file(out), client::read_file(err)};
  }
  Ended ask(const std::string& arguments) const { return run("--server " + server.url() + " " + arguments); }
  std::string in_folder(const std::string& name) const { return "'" + (folder.path() / name).string() + "'"; }
};

}  // namespace mapweld::testing
