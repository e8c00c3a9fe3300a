// The client library against a server that is not there, says no, or answers in pages.
#include "client/client.h"

#include <optional>

#include <gtest/gtest.h>

#include "tests/client/fake_server.h"

namespace mapweld::client {
namespace {

using contract::Json;
using mapweld::testing::FakeServer;

// A port on which nothing listens: one that a server had a moment ago.
std::string nowhere() { return FakeServer().url(); }

std::optional<ServerProblem> problem_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const ServerProblem& problem) {
    return problem;
  }
  return std::nullopt;
}

TEST(ServerAddress, IsTakenOrRefused) {
  for (const char* url : {"http://127.0.0.1:8080", "127.0.0.1:8080", "localhost", "http://[::1]:8080/",
                          "https://maps.example.org/mapweld/"}) {
    EXPECT_NO_THROW(Client{url}) << url;
  }
  for (const char* url : {"", "http://", "ftp://host", "http://host:0", "http://host:99999", "http://host:x",
                          "http://a b", "http://host/?q", "unix:///run/mapweld.sock"}) {
    EXPECT_THROW(Client{url}, std::invalid_argument) << url;
  }
  EXPECT_EQ(Client("host:80/").base_url(), "http://host:80");
}

TEST(Paths, AreEscaped) {
  EXPECT_EQ(path_of("/v1", {"maps", "a b/c"}, {{"name", "\xC3\xA4&=+.jpg"}}),
            "/v1/maps/a%20b%2Fc?name=%C3%A4%26%3D%2B.jpg");
}

TEST(ClientErrors, NobodyAnswers) {
  Client client(nowhere());
  try {
    client.map("lab");
    FAIL();
  } catch (const ConnectionError& error) {
    EXPECT_NE(std::string(error.what()).find("Is mapweld-server running?"), std::string::npos);
  }
}

TEST(ClientErrors, ServerSaysNo) {
  FakeServer server;
  server.script_problem("GET /v1/maps/lab", "no_such_map", "There is no map \"lab\".");
  Client client(server.url());
  const auto problem = problem_of([&] { client.map("lab"); });
  ASSERT_TRUE(problem);
  EXPECT_EQ(problem->status(), 404);
  EXPECT_EQ(problem->code(), "no_such_map");
  EXPECT_EQ(problem->detail(), "There is no map \"lab\".");
  EXPECT_EQ(problem->request_id(), "r1");
}

TEST(ClientErrors, SomethingElseSaysNo) {
  FakeServer server;
  server.script("GET /v1/maps/lab", 502, std::string("<html>Bad gateway</html>"));
  Client client(server.url());
  const auto problem = problem_of([&] { client.map("lab"); });
  ASSERT_TRUE(problem);
  EXPECT_EQ(problem->status(), 502);
  EXPECT_EQ(problem->code(), "");
  EXPECT_EQ(problem->detail(), "HTTP 502.");
}

TEST(ClientErrors, AnswerIsNotTheContracts) {
  FakeServer server;
  server.script("GET /v1/maps/lab", 200, std::string("<html>Welcome</html>"));
  server.script("GET /v1/maps/lab-b", 200, std::string(R"({"name":7})"));
  Client client(server.url());
  EXPECT_THROW(client.map("lab"), UnexpectedAnswer);
  EXPECT_THROW(client.map("lab-b"), UnexpectedAnswer);
}

TEST(ClientLists, FollowPagesToTheEnd) {
  FakeServer server;
  Client client(server.url());
  for (int i = 0; i < 8; ++i) client.upload_image("lab", {std::to_string(i), "bytes"});
  const auto vertices = client.vertices("lab");
  ASSERT_EQ(vertices->size(), 8U);
  EXPECT_EQ((*vertices)[7].name, "7");
  EXPECT_EQ(vertices.json["items"].size(), 8U);
  EXPECT_TRUE(vertices.json["next_cursor"].is_null());
  EXPECT_EQ(server.requests_of("GET /v1/maps/lab/vertices"), 3U);
}

TEST(ClientAnswers, KeepWhatThisClientDoesNotKnow) {
  FakeServer server;
  server.script("GET /v1/maps/lab", 200, std::string(R"({"name":"lab","colour":"red","vertices":12})"));
  const auto map = Client(server.url()).map("lab");
  EXPECT_EQ(map->vertices, 12);
  EXPECT_EQ(map.json["colour"], "red");
}

TEST(ClientRequests, SayOnlyWhatWasAsked) {
  FakeServer server;
  server.script("POST /v1/merges", 202, std::string(R"({"id":1})"));
  server.script("POST /v1/merges/1/resume", 202, std::string(R"({"id":1})"));
  server.script("POST /v1/merges/1/restart", 202, std::string(R"({"id":1})"));
  server.script("GET /v1/merges", 200, std::string(R"({"items":[],"next_cursor":null})"));
  Client client(server.url());
  contract::SubmitMerge request;
  request.maps = {"a", "b"};
  EXPECT_EQ(contract::dump(request), R"({"maps":["a","b"]})");
  EXPECT_EQ(client.submit_merge(request)->id, 1);
  EXPECT_EQ(client.resume_merge(1)->id, 1);
  EXPECT_EQ(client.restart_merge(1)->id, 1);
  EXPECT_EQ(server.bodies().back(), "{}");
  client.merges("paused");
  EXPECT_EQ(server.requests().back(), "GET /v1/merges?state=paused&limit=1000");
}

TEST(ClientRequests, AskForAPairWithItsMatchesOrWithout) {
  FakeServer server;
  server.script("GET /v1/merges/3/pairs/71/12", 200,
                std::string(R"({"u":12,"v":71,"votes":29,"matches":null,"inliers":null,"verdict":"pending",
                                "reason":null})"));
  Client client(server.url());
  const auto pair = client.merge_pair(3, 71, 12);
  EXPECT_EQ(pair->u, 12);
  EXPECT_EQ(pair->verdict, "pending");
  EXPECT_EQ(pair->matches, std::nullopt);
  client.merge_pair(3, 71, 12, true);
  EXPECT_EQ(server.requests(),
            (std::vector<std::string>{"GET /v1/merges/3/pairs/71/12", "GET /v1/merges/3/pairs/71/12?matches=true"}));
  server.script("GET /v1/maps/lab-a/pairs/1/2", 200, std::string(R"({"u":1,"v":2,"map":"lab-a","merge":null})"));
  EXPECT_EQ(client.map_pair("lab-a", 1, 2)->map, "lab-a");
  EXPECT_EQ(server.requests().back(), "GET /v1/maps/lab-a/pairs/1/2");
}

TEST(ClientExport, HandsOnPiecesOrThrows) {
  FakeServer server;
  const std::string graph(3000000, 'x');
  server.script("GET /v1/maps/lab/graph", 200, graph);
  server.script_problem("GET /v1/maps/none/graph", "no_such_map", "There is no map \"none\".");
  Client client(server.url());
  std::string got;
  client.export_graph("lab", "graphml", [&](std::string_view bytes) { got += bytes; });
  EXPECT_EQ(got, graph);
  got.clear();
  const auto problem = problem_of([&] { client.export_graph("none", "dot", [&](std::string_view b) { got += b; }); });
  ASSERT_TRUE(problem);
  EXPECT_EQ(problem->code(), "no_such_map");
  EXPECT_EQ(got, "");
  EXPECT_THROW(client.export_graph("lab", "dot", [](std::string_view) { throw std::runtime_error("full"); }),
               std::runtime_error);
  EXPECT_THROW(client.map("nothing"), ServerProblem);  // the connection can still be used
}

}  // namespace
}  // namespace mapweld::client
