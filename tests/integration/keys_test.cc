// Keys as people use them: the real server, the command that makes keys beside it, the client library.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/support/server_process.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using client::Client;
using client::ServerProblem;
using mapweld::testing::ProcessResult;
using mapweld::testing::run_process;
using mapweld::testing::ServerProcess;
using ::testing::HasSubstr;

contract::CreateMap map_named(const std::string& name) {
  contract::CreateMap map;
  map.name = name;
  return map;
}

struct Keys : ::testing::Test {
  std::string data() const { return (folder.path() / "data").string(); }
  ProcessResult key(std::vector<std::string> arguments) const {
    std::vector<std::string> command = {MAPWELD_SERVER_BINARY, "key"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--data", data()});
    return run_process(command);
  }
  std::string made(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "create");
    ProcessResult result = key(std::move(arguments));
    EXPECT_EQ(result.exit_code, 0);
    result.output.pop_back();  // the line's end
    return result.output;
  }
  // What `call` is answered: the problem's code, or "".
  template <typename Call>
  static std::string code_of(const Call& call) {
    try {
      call();
      return "";
    } catch (const ServerProblem& problem) {
      return problem.code();
    }
  }

  test::TempFolder folder;
};

TEST_F(Keys, AreMadeUsedAndRevokedBesideARunningServer) {
  const ServerProcess server(data());
  EXPECT_EQ(code_of([&] { Client(server.url()).create_map(map_named("before")); }), "");
  const std::string robot = made({"robot", "--role", "write", "--maps", "lab-*"});
  EXPECT_EQ(robot.substr(0, 3), "mw_");
  EXPECT_EQ(code_of([&] { Client(server.url()).maps(); }), "unauthorized");  // from now on
  EXPECT_EQ(code_of([&] { Client(server.url()).health(); }), "");
  Client client(server.url(), {.key = robot});
  EXPECT_EQ(code_of([&] { client.create_map(map_named("lab-a")); }), "");
  EXPECT_EQ(code_of([&] { client.create_map(map_named("hall")); }), "forbidden");
  EXPECT_EQ(client.maps()->size(), 1u);
  contract::SubmitMerge merge;
  merge.maps = {"lab-a", "hall"};
  merge.name = "lab-ab";
  EXPECT_EQ(code_of([&] { client.submit_merge(merge); }), "forbidden");
  EXPECT_EQ(key({"create", "robot", "--role", "read"}).exit_code, 1);
  EXPECT_EQ(key({"create", "chief", "--role", "admin", "--maps", "lab-*"}).exit_code, 1);
  EXPECT_EQ(key({"revoke", "nobody"}).exit_code, 1);
  EXPECT_THAT(key({"list"}).output, HasSubstr("robot  write  lab-*"));
  EXPECT_THAT(key({"list"}).output, ::testing::Not(HasSubstr(robot)));
  EXPECT_EQ(key({"revoke", "robot"}).exit_code, 0);
  EXPECT_EQ(code_of([&] { client.maps(); }), "unauthorized");  // on the connection that is open already, too
  // The key is in no file.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data())) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    EXPECT_EQ(bytes.find(robot.substr(3)), std::string::npos) << entry.path();
  }
}

TEST_F(Keys, AnAddressThatOthersReachNeedsThem) {
  const std::vector<std::string> outside = {"--host", "0.0.0.0"};
  EXPECT_THROW(ServerProcess(data(), outside), std::runtime_error);
  {
    const ServerProcess insecure(data(), {"--host", "0.0.0.0", "--insecure"});
    EXPECT_EQ(code_of([&] { Client(insecure.url()).maps(); }), "");
  }
  const std::string key = made({"chief", "--role", "admin"});
  const ServerProcess server(data(), outside);
  EXPECT_EQ(code_of([&] { Client(server.url()).maps(); }), "unauthorized");
  EXPECT_EQ(code_of([&] { Client(server.url(), {.key = key}).maps(); }), "");
}

}  // namespace
}  // namespace mapweld
