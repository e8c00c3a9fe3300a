// A server that changes nothing: everything is answered, nothing in its folder is another afterwards.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include "client/contract/json.h"
#include "server/config.h"
#include "server/server.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

namespace fs = std::filesystem;
using contract::Json;
using server::Server;
using server::ServerConfig;
using ::testing::HasSubstr;

class Running {
 public:
  explicit Running(const ServerConfig& config) : server_(config), thread_([this] { server_.run(); }) {}
  ~Running() {
    server_.stop();
    thread_.join();
  }
  httplib::Client client() const { return httplib::Client("127.0.0.1", server_.port()); }

 private:
  Server server_;
  std::thread thread_;
};

// Every file below a folder, with its bytes and the time of its last change.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::string& file = files[entry.path().string()];
    file = std::to_string(entry.last_write_time().time_since_epoch().count());
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    file.append(std::istreambuf_iterator<char>(in), {});
  }
  return files;
}

struct ReadOnlyServer : ::testing::Test {
  ReadOnlyServer() {
    const fs::path vocabulary = folder.path() / "words-512.mwv";
    const auto file = small_vocabulary().serialize();
    std::ofstream(vocabulary, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
    config.data = folder.path() / "data";
    config.http.port = 0;
    config.vocabulary = vocabulary;
    const Running running(config);
    auto http = running.client();
    for (const std::string map : {"a", "b"}) {
      http.Post("/v1/maps", R"({"name":")" + map + "\"}", "application/json");
      for (int step = 0; step < 3; ++step) {
        http.Post("/v1/maps/" + map + "/images?name=" + std::to_string(step), photo_jpeg(1, step), "image/jpeg");
      }
    }
    http.Post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})", "application/json");
    for (int i = 0; i < 300 && Json::parse(http.Get("/v1/merges/1")->body)["state"] != "completed"; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    for (const char* path : kLooks) answers[path] = http.Get(path)->body;
    localized = localize(http);
  }

  static Json localize(httplib::Client& http) {
    Json answer = Json::parse(http.Post("/v1/maps/ab/localize", photo_jpeg(1, 1), "image/jpeg")->body);
    answer.erase("took_ms");
    return answer;
  }

  static constexpr const char* kLooks[] = {
      "/v1/maps",     "/v1/maps/a/vertices", "/v1/maps/ab/edges", "/v1/maps/ab/graph", "/v1/maps/a/vertices/1/image",
      "/v1/merges/1/edges", "/v1/merges/1/curve",  "/v1/vocabularies"};
  TempFolder folder;
  ServerConfig config;
  std::map<std::string, std::string> answers;
  Json localized;
};

TEST_F(ReadOnlyServer, AnswersAsTheOneThatWroteAndChangesNothing) {
  config.read_only = true;
  const auto before = contents(config.data);
  {
    const Running running(config);
    auto http = running.client();
    EXPECT_EQ(http.Get("/readyz")->status, 200);
    for (const auto& [path, body] : answers) EXPECT_EQ(http.Get(path)->body, body) << path;
    EXPECT_EQ(localize(http), localized);
    EXPECT_THAT(http.Get("/v1/maps/a/export")->body, HasSubstr("SQLite format 3"));
    const Json page = Json::parse(http.Get("/v1/maps?limit=1")->body);
    EXPECT_EQ(http.Get("/v1/maps?limit=1&cursor=" + page["next_cursor"].get<std::string>())->status, 200);
    EXPECT_EQ(contents(config.data), before);
  }
  EXPECT_EQ(contents(config.data), before);
}

// By the table of routes, so that one made later is held to it too.
TEST_F(ReadOnlyServer, RefusesWhateverChangesSomething) {
  config.read_only = true;
  const auto before = contents(config.data);
  {
    const Running running(config);
    auto http = running.client();
    std::set<std::string> allowed;
    const ApiUnderTest writing;
    for (const server::Route& route : writing.routes()) {
      if (route.method == "GET") continue;
      httplib::Request request;
      request.method = route.method;
      request.path = route.pattern;
      for (const char* name : {"{map}", "{vertex}", "{u}", "{v}", "{merge}", "{vocabulary}", "{backup}"}) {
        const std::size_t at = request.path.find(name);
        if (at != std::string::npos) request.path.replace(at, std::string(name).size(), "1");
      }
      request.body = "{}";
      request.set_header("Content-Type", "application/json");
      const auto answer = http.send(request);
      ASSERT_TRUE(answer) << route.pattern;
      if (answer->status == 403) {
        EXPECT_EQ(Json::parse(answer->body)["code"], "read_only") << route.pattern;
      } else {
        allowed.insert(route.method + " " + route.pattern);
      }
    }
    EXPECT_THAT(allowed, testing::ElementsAre("POST /v1/maps/{map}/localize"));
  }
  EXPECT_EQ(contents(config.data), before);
}

}  // namespace
}  // namespace mapweld::test
