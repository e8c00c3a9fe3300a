// The paths of docs/http-api.md over loopback, as a client sees them.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "client/contract/graph.h"
#include "client/contract/image.h"
#include "client/contract/map.h"
#include "client/contract/merge.h"
#include "client/contract/route.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Api, TellsHowItIs) {
  ApiUnderTest api;
  EXPECT_EQ(api.get("/healthz").json()["status"], "ok");
  EXPECT_EQ(api.get("/readyz").status, 200);
  api.ready = false;
  EXPECT_EQ(api.get("/readyz").status, 503);
  EXPECT_EQ(api.get("/version").json()["version"], MAPWELD_VERSION);
  const Answer metrics = api.get("/metrics");
  EXPECT_THAT(metrics.header("Content-Type"), StartsWith("text/plain; version=0.0.4"));
  EXPECT_THAT(metrics.body, HasSubstr("mapweld_stage_duration_seconds_count{stage=\"sift\"} 0"));
}

TEST(Api, TheWholeWayFromPhotographsToAMergedMap) {
  ApiUnderTest api;
  const Answer created = api.post("/v1/maps", R"({"name":"a","labels":{"robot":"p3at-1"}})");
  EXPECT_EQ(created.status, 201);
  EXPECT_EQ(created.header("Location"), "/v1/maps/a");
  const std::string uuid = created.json()["uuid"];
  api.post("/v1/maps", R"({"name":"b"})");

  const Answer first = api.post_image(
      "/v1/maps/a/images?name=000.jpg&captured_at=2026-11-23T11:00:00%2B01:00&sequence=run-1&index=7&map_uuid=" + uuid,
      photo_jpeg(1, 0));
  EXPECT_EQ(first.status, 201);
  EXPECT_EQ(first.header("Location"), "/v1/maps/a/vertices/0");
  EXPECT_EQ(first.json().get<contract::Upload>().outcome, "inserted");
  EXPECT_TRUE(first.json().contains("reason"));
  const Answer again = api.post_image("/v1/maps/a/images?name=000.jpg", photo_jpeg(1, 0));
  EXPECT_EQ(again.status, 200);
  EXPECT_EQ(again.json()["vertex"], 0);
  const Answer similar = api.post_image("/v1/maps/a/images?name=again.png", png(photo(1, 0)));
  EXPECT_EQ(similar.status, 200);
  EXPECT_EQ(similar.json()["outcome"], "ignored");
  EXPECT_EQ(similar.json()["similar_to"], 0);
  EXPECT_FALSE(similar.json().contains("vertex"));

  const contract::Json vertex = api.get("/v1/maps/a/vertices/0").json();
  EXPECT_EQ(vertex["captured_at"], "2026-11-23T10:00:00Z");
  EXPECT_EQ(vertex["sequence"], "run-1");
  EXPECT_EQ(vertex["index"], 7);
  EXPECT_TRUE(vertex["camera"].is_null());
  const Answer bytes = api.get("/v1/maps/a/vertices/0/image");
  EXPECT_EQ(bytes.header("Content-Type"), "image/jpeg");
  EXPECT_EQ(bytes.body, photo_jpeg(1, 0));
  EXPECT_EQ(api.get("/v1/maps/a/ignored").json()["items"][0]["name"], "again.png");

  std::vector<std::pair<std::string, std::string>> images_a = {{"000.jpg", photo_jpeg(1, 0)}};
  std::vector<std::pair<std::string, std::string>> images_b;
  for (int step = 1; step < 4; ++step) {
    images_a.emplace_back("00" + std::to_string(step) + ".jpg", photo_jpeg(1, step));
    images_b.emplace_back("10" + std::to_string(step) + ".jpg", photo_jpeg(1, step + 1));
  }
  images_b.emplace_back("broken.jpg", "not an image");
  const auto batch = api.post_batch("/v1/maps/a/images/batch", images_a).json().get<contract::Batch>();
  ASSERT_EQ(batch.items.size(), 4u);
  EXPECT_EQ(std::get<contract::Upload>(batch.items[3]).vertex, 3);
  const Answer mixed = api.post_batch("/v1/maps/b/images/batch", images_b);
  EXPECT_EQ(mixed.status, 200);
  const auto problem = std::get<contract::Problem>(mixed.json().get<contract::Batch>().items.at(3));
  EXPECT_EQ(problem.code, "unsupported_image");
  EXPECT_EQ(problem.status, 415);
  EXPECT_EQ(problem.request_id, mixed.header("X-Request-Id"));

  const Answer submitted = api.post("/v1/merges", R"({"maps":["a","b"],"name":"ab","seed":7})");
  EXPECT_EQ(submitted.status, 202);
  EXPECT_EQ(submitted.header("Location"), "/v1/merges/1");
  EXPECT_EQ(submitted.header("Retry-After"), "1");
  EXPECT_EQ(submitted.json()["seed"], 7);
  const contract::Json merge = api.finished_merge(1);
  EXPECT_EQ(merge["state"], "completed");
  EXPECT_EQ(merge["links"]["self"], "/v1/merges/1");
  EXPECT_EQ(api.get("/v1/merges/1").header("Retry-After"), "");
  EXPECT_EQ(api.get("/v1/merges?state=completed").json()["items"].size(), 1u);
  EXPECT_EQ(api.get("/v1/merges?state=running").json()["items"].size(), 0u);
  const contract::Json curve = api.get("/v1/merges/1/curve").json()["items"];
  ASSERT_FALSE(curve.empty());
  EXPECT_EQ(curve.back()["edges"], merge["edges"]);
  const contract::Json edges = api.get("/v1/merges/1/edges").json()["items"];
  EXPECT_EQ(edges.size(), merge["edges"].get<std::size_t>());

  const Answer found = api.post_image("/v1/maps/ab/localize?limit=1", photo_jpeg(1, 4));
  EXPECT_EQ(found.json()["status"], "localized");
  ASSERT_EQ(found.json()["matches"].size(), 1u);
  EXPECT_EQ(found.json()["matches"][0]["map"], "b");
  EXPECT_EQ(api.get("/v1/maps/ab/route?from=0&to=6").json().get<contract::Route>().vertices.front(), 0);
  EXPECT_EQ(api.get("/v1/maps/ab/quality").json()["vertices"], 7);
  EXPECT_EQ(api.get("/v1/maps/ab/graph").json().get<contract::Graph>().vertices.size(), 7u);
  EXPECT_THAT(api.get("/v1/maps/ab/graph?format=csv").header("Content-Type"), StartsWith("text/csv"));

  EXPECT_EQ(api.post("/v1/merges/1/cancel", "").code(), "wrong_state");
  EXPECT_EQ(api.del("/v1/merges/1").status, 204);
  EXPECT_EQ(api.get("/v1/maps/ab").code(), "no_such_map");
  EXPECT_EQ(api.del("/v1/maps/a").status, 204);
  EXPECT_EQ(api.get("/v1/maps").json()["items"].size(), 1u);
}

TEST(Api, ABudgetStopsAMergeAndResumeFinishesIt) {
  ApiUnderTest api;
  for (const char* map : {"a", "b"}) {
    api.services().create_map(map);
    for (int step = 0; step < 8; ++step) api.services().upload(map, std::to_string(step), photo_jpeg(1, step));
  }
  api.post("/v1/merges", R"({"maps":["a","b"],"name":"whole"})");
  const contract::Json whole = api.finished_merge(1);
  api.post("/v1/merges", R"({"maps":["a","b"],"name":"parts","budget":{"verifications":3}})");
  const contract::Json stopped = api.finished_merge(2);
  EXPECT_EQ(stopped["state"], "budget_exhausted");
  EXPECT_EQ(stopped["stop_reason"], "verifications");
  EXPECT_EQ(stopped["candidates"]["verified"], 3);
  EXPECT_EQ(stopped["budget"], contract::Json::parse(R"({"verifications":3})"));
  EXPECT_EQ(api.post_image("/v1/maps/parts/localize", photo_jpeg(1, 3)).json()["status"], "localized");
  const Answer more = api.post("/v1/merges/2/resume", R"({"budget":{"verifications":2}})");
  EXPECT_EQ(more.status, 202);
  EXPECT_EQ(api.finished_merge(2)["candidates"]["verified"], 5);
  EXPECT_EQ(api.post("/v1/merges/2/resume", "").status, 202);
  const contract::Json finished = api.finished_merge(2);
  EXPECT_EQ(finished["state"], "completed");
  EXPECT_EQ(finished["edges"], whole["edges"]);
}

TEST(Api, AMergeIsRestartedUnderItsNumber) {
  ApiUnderTest api;
  for (const char* map : {"a", "b"}) {
    api.services().create_map(map);
    for (int step = 0; step < 8; ++step) api.services().upload(map, std::to_string(step), photo_jpeg(1, step));
  }
  api.post("/v1/merges", R"({"maps":["a","b"],"name":"ab","method":"quickconnect"})");
  const contract::Json whole = api.finished_merge(1);
  // The map is in use before, while and after its edges go.
  EXPECT_EQ(api.post_image("/v1/maps/ab/localize", photo_jpeg(1, 3)).json()["status"], "localized");
  const Answer begun = api.post("/v1/merges/1/restart", R"({"budget":{"verifications":3}})");
  EXPECT_EQ(begun.status, 202);
  EXPECT_EQ(begun.json()["id"], 1);
  EXPECT_EQ(begun.json()["map"], "ab");
  const contract::Json stopped = api.finished_merge(1);
  EXPECT_EQ(stopped["state"], "budget_exhausted");
  EXPECT_EQ(stopped["candidates"]["verified"], 3);
  EXPECT_EQ(api.get("/v1/merges/1/edges").json()["items"].size(), stopped["edges"]);
  EXPECT_EQ(api.post_image("/v1/maps/ab/localize", photo_jpeg(1, 3)).json()["status"], "localized");
  EXPECT_EQ(api.post("/v1/merges/1/restart", R"({"budget":{}})").status, 202);
  EXPECT_EQ(api.finished_merge(1)["edges"], whole["edges"]);
  EXPECT_EQ(api.post("/v1/merges", R"({"maps":["ab","a"],"name":"x"})").code(), "duplicate_member");
  api.services().create_map("c");
  api.post("/v1/merges", R"({"maps":["ab","c"],"name":"abc"})");
  EXPECT_EQ(api.post("/v1/merges/1/restart", "").code(), "map_in_use");
  EXPECT_EQ(api.post("/v1/merges/7/restart", "").code(), "no_such_merge");
}

TEST(Api, TakesImagesOfEveryUsualKind) {
  ApiUnderTest api;
  api.services().create_map("lab");
  const cv::Mat colour = photo(1, 0);
  cv::Mat deep;
  photo(2, 0).convertTo(deep, CV_16U, 257);
  cv::Mat grey;
  cv::cvtColor(photo(3, 0), grey, cv::COLOR_BGR2GRAY);
  cv::Mat alpha;
  cv::cvtColor(photo(4, 0), alpha, cv::COLOR_BGR2BGRA);
  for (const std::string& image : {jpeg(colour), png(deep), png(grey), jpeg(grey), png(alpha), png(blank(1, 1))}) {
    const Answer answer = api.post_image("/v1/maps/lab/images", image);
    EXPECT_THAT(answer.status, ::testing::AnyOf(200, 201)) << answer.body;
  }
}

TEST(Api, ExplainsAnyPairOfAMerge) {
  ApiUnderTest api;
  for (const char* map : {"a", "b"}) {
    api.services().create_map(map);
    for (int step = 0; step < 3; ++step) api.services().upload(map, std::to_string(step), photo_jpeg(1, step));
  }
  api.post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})");
  api.finished_merge(1);
  const Answer answer = api.get("/v1/merges/1/pairs/4/1");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, api.get("/v1/merges/1/pairs/1/4").body);
  const contract::Json pair = answer.json();
  EXPECT_EQ(pair["u"], 1);
  EXPECT_EQ(pair["v"], 4);
  EXPECT_EQ(pair["verdict"], "accepted");
  EXPECT_TRUE(pair.contains("reason") && pair["reason"].is_null());
  EXPECT_FALSE(pair.contains("inlier_matches"));
  const contract::Json with_matches = api.get("/v1/merges/1/pairs/1/4?matches=true").json();
  EXPECT_EQ(with_matches["inlier_matches"].size(), pair["inliers"].get<std::size_t>());
  EXPECT_GE(with_matches["inlier_matches"][0]["u"]["x_px"], 0);
  EXPECT_EQ(api.get("/v1/merges/1/pairs/0/5").json()["reason"].is_string(), true);

  EXPECT_EQ(api.get("/v1/merges/2/pairs/1/4").code(), "no_such_merge");
  EXPECT_EQ(api.get("/v1/merges/x/pairs/1/4").code(), "no_such_merge");
  for (const char* vertex : {"6", "99999999999999999999", "-1", "x", "1.5", "%20"}) {
    EXPECT_EQ(api.get("/v1/merges/1/pairs/0/" + std::string(vertex)).code(), "no_such_vertex") << vertex;
    EXPECT_EQ(api.get("/v1/merges/1/pairs/" + std::string(vertex) + "/0").code(), "no_such_vertex") << vertex;
  }
  EXPECT_EQ(api.get("/v1/merges/1/pairs/0/1").json()["map"], "a");
  contract::Json of_b = api.get("/v1/merges/1/pairs/3/4").json();
  for (const char* vertex : {"u", "v"}) of_b[vertex] = of_b[vertex].get<int>() - 3;
  EXPECT_EQ(api.get("/v1/maps/b/pairs/1/0").json(), of_b);
  EXPECT_TRUE(of_b["merge"].is_null());
  EXPECT_EQ(of_b["verdict"], "accepted");
  EXPECT_EQ(api.get("/v1/maps/ab/pairs/4/1?matches=true").json(), with_matches);
  EXPECT_EQ(api.get("/v1/maps/x/pairs/0/1").code(), "no_such_map");
  EXPECT_EQ(api.get("/v1/maps/b/pairs/0/3").code(), "no_such_vertex");
  EXPECT_EQ(api.get("/v1/maps/b/pairs/0/1?match=true").code(), "unknown_field");
  EXPECT_EQ(api.get("/v1/merges/1/pairs/1/1").code(), "invalid_parameter");
  EXPECT_EQ(api.get("/v1/merges/1/pairs/1/1").status, 422);
  EXPECT_EQ(api.get("/v1/merges/1/pairs/1/4?matches=perhaps").code(), "invalid_parameter");
  EXPECT_EQ(api.get("/v1/merges/1/pairs/1/4?match=true").code(), "unknown_field");
}

TEST(Api, MergesByEveryMethodWithTheSameEdges) {
  ApiUnderTest api;
  for (const char* map : {"a", "b"}) {
    api.services().create_map(map);
    for (int step = 0; step < 4; ++step) api.services().upload(map, std::to_string(step), photo_jpeg(1, step));
  }
  std::int64_t id = 0;
  std::set<std::pair<int, int>> expected;
  for (const std::string_view method : contract::kMergeMethods) {
    const std::string name = "by-" + std::string(method);
    const Answer answer = api.post(
        "/v1/merges", R"({"maps":["a","b"],"name":")" + name + R"(","method":")" + std::string(method) + "\"}");
    ASSERT_EQ(answer.status, 202) << answer.body;
    const contract::Json done = api.finished_merge(++id);
    EXPECT_EQ(done["state"], "completed") << method;
    EXPECT_EQ(done["certified_fraction"], 1.0) << method;
    EXPECT_EQ(done["pairs"].size(), 1u);
    EXPECT_EQ(done["parameters"]["alias_guard"], method == "spectral");
    if (method == "alignment") continue;  // the one with candidates of its own
    std::set<std::pair<int, int>> edges;
    const contract::Json listed = api.get("/v1/merges/" + std::to_string(id) + "/edges").json();
    for (const contract::Json& edge : listed["items"]) edges.emplace(edge["u"], edge["v"]);
    if (expected.empty()) expected = edges;
    EXPECT_EQ(edges, expected) << method;
  }
  EXPECT_GT(expected.size(), 3u);
}

TEST(Api, MergesSeveralMapsAsTheyGrowUnderTheAliasGuard) {
  ApiUnderTest api;
  for (const char* map : {"a", "b", "c"}) {
    api.services().create_map(map);
    for (int step = 0; step < 3; ++step) api.services().upload(map, std::to_string(step), photo_jpeg(1, step));
  }
  api.services().create_map("elsewhere");
  for (int step = 0; step < 3; ++step) api.services().upload("elsewhere", std::to_string(step), photo_jpeg(2, step));
  const Answer answer =
      api.post("/v1/merges", R"({"maps":["a","b","c","elsewhere"],"name":"all","parameters":{"alias_guard":true}})");
  ASSERT_EQ(answer.status, 202) << answer.body;
  contract::Json done = api.finished_merge(1);
  EXPECT_EQ(done["state"], "completed") << done;
  ASSERT_EQ(done["pairs"].size(), 6u);
  for (const contract::Json& pair : done["pairs"]) {
    const bool is_elsewhere = pair["maps"][1] == "elsewhere";
    EXPECT_EQ(pair["verdict"] == "not_joined", is_elsewhere) << pair;
  }
  // Two layers: what is not confirmed is listed with its reason; together they are all that was accepted.
  const contract::Json doubted = api.get("/v1/maps/all/edges?kind=inter&confirmed=false&limit=1000").json()["items"];
  const contract::Json standing = api.get("/v1/maps/all/edges?kind=inter&confirmed=true&limit=1000").json()["items"];
  EXPECT_EQ(doubted.size() + standing.size(), done["edges"].get<std::size_t>());
  for (const contract::Json& edge : doubted) {
    EXPECT_EQ(edge["confirmed"], false);
    EXPECT_THAT(edge["reason"].get<std::string>(), ::testing::AnyOf("unsupported", "ambiguous"));
    EXPECT_LT(edge["confidence"].get<double>(), done["parameters"]["min_confidence"].get<double>());
  }
  for (const contract::Json& edge : standing) {
    EXPECT_FALSE(edge.contains("reason"));
    EXPECT_GE(edge["confidence"].get<double>(), done["parameters"]["min_confidence"].get<double>());
  }
  EXPECT_EQ(done["edge_counts"],
            (contract::Json{{"verified", doubted.size() + standing.size()}, {"confirmed", standing.size()}}));
  const contract::Json inner = api.get("/v1/maps/all/edges?kind=inner&limit=1000").json()["items"];
  EXPECT_GT(inner.size(), 0u);
  for (const contract::Json& edge : inner) {
    EXPECT_EQ(edge["confirmed"], true);
    EXPECT_EQ(edge["confidence"], nullptr);
  }
  const contract::Json of_map = api.get("/v1/maps/all").json();
  EXPECT_EQ(of_map["edge_counts"]["verified"], inner.size() + doubted.size() + standing.size());
  EXPECT_EQ(of_map["edge_counts"]["confirmed"], inner.size() + standing.size());
  EXPECT_EQ(api.get("/v1/maps/all/quality").json()["edge_counts"], of_map["edge_counts"]);
  const contract::Json by_insertion = api.get("/v1/merges/1/edges?limit=1000").json()["items"];
  EXPECT_EQ(std::ranges::count_if(by_insertion, [](const auto& edge) { return edge["confirmed"] == true; }),
            static_cast<std::ptrdiff_t>(standing.size()));
  for (const char* wrong : {"1.5", "-0.1", "\"much\""}) {
    const Answer refused =
        api.post("/v1/merges", R"({"maps":["a","b"],"parameters":{"min_confidence":)" + std::string(wrong) + "}}");
    EXPECT_EQ(refused.status, 422) << wrong;
    EXPECT_EQ(refused.code(), "invalid_parameter") << wrong;
  }
  // Growth: nothing to resume before, new vertices after.
  EXPECT_EQ(api.post("/v1/merges/1/resume", "").code(), "nothing_to_resume");
  api.services().upload("b", "later", photo_jpeg(1, 3));
  EXPECT_EQ(api.get("/v1/maps/all").json()["vertices"], 12);
  EXPECT_EQ(api.post("/v1/merges/1/resume", "").status, 202);
  done = api.finished_merge(1);
  EXPECT_EQ(done["state"], "completed") << done;
  EXPECT_EQ(api.get("/v1/maps/all").json()["vertices"], 13);
  EXPECT_EQ(api.get("/v1/maps/all/vertices/12").json()["name"], "later");
  EXPECT_EQ(api.post_image("/v1/maps/all/localize", photo_jpeg(1, 3)).json()["status"], "localized");
}

TEST(Api, AFractionOfTheMaximumIsABudget) {
  ApiUnderTest api;
  for (const char* map : {"a", "b"}) {
    api.services().create_map(map);
    for (int step = 0; step < 3; ++step) api.services().upload(map, std::to_string(step), photo_jpeg(1, step));
  }
  for (const char* budget : {R"({"fraction_of_maximum":0.9})", R"({"fraction_of_maximum":1,"certified":true})"}) {
    EXPECT_EQ(api.post("/v1/merges", R"({"maps":["a","b"],"budget":)" + std::string(budget) + R"(,"name":"ab)" +
                                         std::to_string(std::string(budget).size()) + "\"}")
                  .status,
              202);
  }
  EXPECT_EQ(api.finished_merge(1)["state"], "completed") << "fewer candidates than are verified before the first test";
  EXPECT_EQ(api.finished_merge(1)["parameters"]["serves_certificate"], false);
  EXPECT_EQ(api.finished_merge(2)["parameters"]["serves_certificate"], true) << "as its first budget is judged";
}

}  // namespace
}  // namespace mapweld::test
