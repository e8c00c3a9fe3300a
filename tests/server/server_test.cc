// The server as one object: starting, stopping, starting again.
#include "server/server.h"

#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <regex>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "client/contract/json.h"
#include "schema/engine/store_error.h"
#include "server/config.h"
#include "tests/server/support/test_photos.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

using contract::Json;
using server::Server;
using server::ServerConfig;
using ::testing::AnyOf;
using ::testing::HasSubstr;

class ServerTest : public ::testing::Test {
 protected:
  ServerTest() {
    vocabulary_ = folder_.path() / "words-512.mwv";
    const auto file = small_vocabulary().serialize();
    std::ofstream(vocabulary_, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  }

  ServerConfig config() const {
    ServerConfig config;
    config.data = folder_.path() / "data";
    config.http.port = 0;
    config.vocabulary = vocabulary_;
    return config;
  }

  TempFolder folder_;
  std::filesystem::path vocabulary_;
};

// Runs until it goes.
class Running {
 public:
  explicit Running(const ServerConfig& config) : server_(config), thread_([this] { server_.run(); }) {}
  ~Running() {
    server_.stop();
    thread_.join();
  }
  httplib::Client client() const { return httplib::Client("127.0.0.1", server_.port()); }
  Server& server() { return server_; }

 private:
  Server server_;
  std::thread thread_;
};

// The value of a series, as /metrics shows it; nothing where it is not shown.
std::optional<double> series(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("\n" + name + " ");
  if (at == std::string::npos) return std::nullopt;
  return std::stod(text.substr(at + name.size() + 2));
}

TEST_F(ServerTest, MetricsAndLogSayWhatMergesDid) {
  std::ostringstream lines;
  spdlog::drop("merges");
  spdlog::register_logger(
      std::make_shared<spdlog::logger>("merges", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines)));
  const Running running(config());
  auto http = running.client();
  for (const std::string map : {"a", "b"}) {
    http.Post("/v1/maps", R"({"name":")" + map + "\"}", "application/json");
    for (int step = 0; step < 4; ++step) {
      http.Post("/v1/maps/" + map + "/images?name=" + std::to_string(step), photo_jpeg(1, step), "image/jpeg");
    }
  }
  http.Post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})", "application/json");
  Json merge = Json::object();
  for (int i = 0; i < 300 && merge.value("state", "") != "completed"; ++i) {
    merge = Json::parse(http.Get("/v1/merges/1")->body);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const std::string text = http.Get("/metrics")->body;
  EXPECT_EQ(series(text, "mapweld_merges{state=\"completed\"}"), 1.0);
  EXPECT_EQ(series(text, "mapweld_merges{state=\"failed\"}"), 0.0);
  EXPECT_GT(merge["edges"].get<double>(), 0);
  EXPECT_EQ(series(text, "mapweld_merge_edges_total"), merge["edges"].get<double>());
  EXPECT_EQ(series(text, "mapweld_merge_verifications_total"), merge["candidates"]["verified"].get<double>());
  EXPECT_GE(series(text, "mapweld_connections").value_or(0), 1.0);
  EXPECT_EQ(series(text, "mapweld_event_streams"), 0.0);
  EXPECT_THAT(lines.str(), HasSubstr("event=merge merge=1 map=ab method=spectral state=running"));
  EXPECT_THAT(lines.str(), HasSubstr("state=completed verifications=" + merge["candidates"]["verified"].dump()));
  spdlog::drop("merges");

  // The dashboard asks for nothing that is not there.
  std::ifstream in(MAPWELD_SOURCE_DIR "/docker/grafana.json");
  const std::string dashboard((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const Json panels = Json::parse(dashboard)["panels"];
  EXPECT_GE(panels.size(), 8u);
  const std::regex name("mapweld_[a-z_]+");
  for (const Json& panel : panels) {
    for (const Json& target : panel["targets"]) {
      const std::string expression = target["expr"];
      for (std::sregex_iterator found(expression.begin(), expression.end(), name), end; found != end; ++found) {
        EXPECT_THAT(text, AnyOf(HasSubstr("\n" + found->str() + " "), HasSubstr("\n" + found->str() + "{")));
      }
    }
  }
}

TEST_F(ServerTest, KeepsEverythingOverARestart) {
  {
    const Running running(config());
    auto http = running.client();
    EXPECT_EQ(http.Get("/readyz")->status, 200);
    EXPECT_EQ(http.Post("/v1/maps", R"({"name":"a"})", "application/json")->status, 201);
    EXPECT_EQ(http.Post("/v1/maps", R"({"name":"b"})", "application/json")->status, 201);
    for (int step = 0; step < 3; ++step) {
      const std::string query = "?name=" + std::to_string(step);
      EXPECT_EQ(http.Post("/v1/maps/a/images" + query, photo_jpeg(1, step), "image/jpeg")->status, 201);
      EXPECT_EQ(http.Post("/v1/maps/b/images" + query, photo_jpeg(1, step), "image/jpeg")->status, 201);
    }
    EXPECT_EQ(http.Post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})", "application/json")->status, 202);
  }
  // Whatever the merge had reached when the server stopped: it is finished by the next one.
  const Running running(config());
  auto http = running.client();
  Json merge = Json::object();
  for (int i = 0; i < 300 && merge.value("state", "") != "completed"; ++i) {
    merge = Json::parse(http.Get("/v1/merges/1")->body);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_EQ(merge["state"], "completed");
  EXPECT_GT(merge["edges"], 0);
  std::int64_t verified = merge["edge_counts"]["verified"];
  for (const char* map : {"a", "b"}) {
    verified +=
        Json::parse(http.Get(std::string("/v1/maps/") + map)->body)["edge_counts"]["verified"].get<std::int64_t>();
  }
  const std::string metrics = http.Get("/metrics")->body;
  EXPECT_THAT(metrics, HasSubstr("\nmapweld_edges_verified " + std::to_string(verified) + "\n"));
  EXPECT_THAT(metrics, HasSubstr("\nmapweld_edges_confirmed "));
  EXPECT_EQ(Json::parse(http.Get("/v1/vocabularies")->body)["items"].size(), 1u);  // not taken in twice
  EXPECT_EQ(Json::parse(http.Get("/v1/maps/a")->body)["vocabulary"], "words-512");
  EXPECT_EQ(Json::parse(http.Post("/v1/maps/ab/localize", photo_jpeg(1, 2), "image/jpeg")->body)["status"],
            "localized");
}

TEST_F(ServerTest, StopsWithinSecondsWhileClientsAreBusy) {
  Running running(config());
  auto http = running.client();
  http.Post("/v1/maps", R"({"name":"a"})", "application/json");
  httplib::MultipartFormDataItems images;
  for (int i = 0; i < 24; ++i) {
    images.push_back({"image", photo_jpeg(static_cast<std::uint64_t>(i), 0), std::to_string(i), "image/jpeg"});
  }
  int inserted = 0;
  int refused = 0;
  std::thread upload([&] {
    auto own = running.client();
    own.set_read_timeout(30);
    const auto reply = own.Post("/v1/maps/a/images/batch", images);
    ASSERT_TRUE(reply);
    const Json batch = Json::parse(reply->body);
    for (const Json& item : batch["items"]) {
      if (item.contains("outcome")) ++inserted;
      if (item.value("code", "") == "shutting_down") ++refused;
    }
  });
  while (Json::parse(http.Get("/v1/maps/a")->body)["vertices"] == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const auto started = std::chrono::steady_clock::now();
  running.server().stop();
  upload.join();
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(15));  // 5 on a machine of its own
  EXPECT_GT(inserted, 0);
  EXPECT_EQ(inserted + refused, 24);  // every image has its answer
}

TEST_F(ServerTest, ADataFolderBelongsToOneServer) {
  const Running running(config());
  try {
    const Server second(config());
    FAIL() << "two servers over one data folder";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kFolderInUse);
  }
  EXPECT_EQ(running.client().Get("/healthz")->status, 200);
}

TEST_F(ServerTest, ForeignAndNewerDatabasesAreLeftAlone) {
  std::filesystem::create_directories(config().data);
  const auto file = config().data / "mapweld.db";
  {
    sqlite::Connection db(file, sqlite::OpenMode::kCreate);
    db.execute("PRAGMA application_id = 7; CREATE TABLE recipes (name TEXT) STRICT");
  }
  try {
    const Server server(config());
    FAIL() << "opened another application's database";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kForeignDatabase);
    EXPECT_THAT(error.what(), HasSubstr("mapweld.db"));
  }
  std::filesystem::remove_all(config().data);
  { const Server server(config()); }
  {
    sqlite::Connection db(file, sqlite::OpenMode::kReadWrite);
    db.execute("PRAGMA user_version = 4711");
  }
  try {
    const Server server(config());
    FAIL() << "opened a newer database";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kNewerVersion);
  }
}

TEST_F(ServerTest, ABrokenVocabularyIsSaid) {
  ServerConfig broken = config();
  broken.vocabulary = folder_.path() / "text.mwv";
  std::ofstream(*broken.vocabulary) << "hello";
  EXPECT_THROW(Server{broken}, std::runtime_error);
  broken.vocabulary = folder_.path() / "missing.mwv";
  EXPECT_THROW(Server{broken}, std::runtime_error);
}

TEST_F(ServerTest, AnEmptyDataFolderLoadsTheShippedVocabulary) {
  if (!server::find_shipped_vocabulary()) GTEST_SKIP() << "vocabularies/indoor-50k is not there";
  ServerConfig plain = config();
  plain.vocabulary.reset();
  const Running running(plain);
  const Json vocabulary = Json::parse(running.client().Get("/v1/vocabularies/indoor-50k")->body);
  EXPECT_EQ(vocabulary["words"], 50'000);
  running.client().Post("/v1/maps", R"({"name":"a"})", "application/json");
  EXPECT_EQ(Json::parse(running.client().Get("/v1/maps/a")->body)["vocabulary"], "indoor-50k");
}

}  // namespace
}  // namespace mapweld::test
