// Answers that a client has already are not sent again, and never when they have changed.
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

class Conditional : public ::testing::Test {
 protected:
  // The status for a client that has what `tag` stands for.
  int status(const std::string& path, const std::string& tag) const {
    const Answer answer = api_.ask("GET", path, {{"If-None-Match", tag}});
    EXPECT_EQ(answer.status == 304, answer.body.empty());
    return answer.status;
  }
  int status_of(const std::string& path, const std::string& tag) const {
    return api_.ask("GET", path, {{"If-None-Match", tag}}).status;
  }
  std::string tag(const std::string& path) const {
    const Answer answer = api_.get(path);
    EXPECT_EQ(answer.status, 200) << path;
    EXPECT_EQ(answer.header("Cache-Control"), "private, no-cache") << path;
    return answer.header("ETag");
  }
  void judge_first_edge(const std::string& map) {
    Store& store = api_.services().store();
    WriteTransaction db = store.write();
    const MapId id = find_map(db, map).value().id;
    const JudgedEdge edge{VertexId{0}, VertexId{1}, {.confidence = 0.99, .made_of = {}}};
    set_judgements(db, id, {&edge, 1});
    db.commit();
  }
  void make_map(const std::string& name, int first_step) {
    api_.post("/v1/maps", R"({"name":")" + name + R"("})");
    for (int step = first_step; step < first_step + 3; ++step) {
      api_.post_image("/v1/maps/" + name + "/images?name=" + std::to_string(step), photo_jpeg(1, step));
    }
  }
  static std::vector<std::string> paths(const std::string& map) {
    std::vector<std::string> paths;
    for (const char* path : {"", "/vertices", "/vertices?name=1", "/vertices/1", "/edges", "/edges?confirmed=true",
                             "/graph", "/graph?format=csv", "/quality", "/route?from=0&to=1"}) {
      paths.push_back("/v1/maps/" + map + path);
    }
    return paths;
  }
  ApiUnderTest api_;
};

TEST_F(Conditional, WhatAMapShowsChangesWithItsImagesAndItsJudgements) {
  make_map("a", 0);
  for (const std::string& path : paths("a")) {
    const std::string before = tag(path);
    EXPECT_EQ(status(path, before), 304) << path;
    EXPECT_EQ(status(path, "\"other\", " + before), 304) << path;
    EXPECT_EQ(status(path, "\"other\""), 200) << path;
    api_.post_image("/v1/maps/a/images", photo_jpeg(2, 0));
    EXPECT_EQ(status(path, before), 200) << path;
    const std::string grown = tag(path);
    EXPECT_EQ(status(path, grown), 304) << path;
    judge_first_edge("a");
    EXPECT_EQ(status(path, grown), 200) << path;
    api_.put("/v1/maps/a/mask", png(cv::Mat(240, 320, CV_8UC1, cv::Scalar(255))), "image/png");
    api_.post("/v1/maps", R"({"name":"other"})");
    EXPECT_EQ(status(path, tag(path)), 304) << path;
  }
  EXPECT_EQ(api_.get("/v1/maps/a/edges").json()["items"][0]["confidence"], 0.99);
}

TEST_F(Conditional, WhatAMergedMapShowsChangesWithItsMembersJudgementsAndNotWithTheirNewImages) {
  make_map("a", 0);
  make_map("b", 2);
  api_.post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})");
  api_.finished_merge(1);
  for (const std::string& path : paths("ab")) {
    const std::string before = tag(path);
    const std::string body = api_.get(path).body;
    api_.post_image("/v1/maps/a/images", photo_jpeg(1, 5));
    EXPECT_EQ(status(path, before), 304) << path;
    EXPECT_EQ(api_.get(path).body, body) << path;
    judge_first_edge("b");
    EXPECT_EQ(status(path, before), 200) << path;
  }
  const std::string before = tag("/v1/maps/ab");
  api_.post("/v1/merges/1/resume", "");
  api_.finished_merge(1);
  EXPECT_EQ(status("/v1/maps/ab", before), 200);
}

TEST_F(Conditional, AMapThatIsGoneIsNotWhatItWas) {
  make_map("a", 0);
  const std::string before = tag("/v1/maps/a");
  const std::string uuid = api_.get("/v1/maps/a").json()["uuid"];
  api_.del("/v1/maps/a");
  EXPECT_EQ(status("/v1/maps/a", before), 404);
  api_.post("/v1/maps", R"({"name":"a","uuid":")" + uuid + R"("})");
  EXPECT_EQ(status("/v1/maps/a", before), 200);
}

TEST_F(Conditional, WhatWouldBeRefusedIsRefusedWithWhateverTag) {
  make_map("a", 0);
  const std::string map = tag("/v1/maps/a");
  const std::string list = tag("/v1/maps/a/vertices");
  for (const std::string& known : {map, list, std::string("*")}) {
    EXPECT_EQ(status_of("/v1/maps/a/vertices/77", known), 404) << known;
    EXPECT_EQ(status_of("/v1/maps/a/graph?format=png", known), 422) << known;
    EXPECT_EQ(status_of("/v1/maps/a/vertices?limit=nonsense", known), 422) << known;
  }
  EXPECT_EQ(status("/v1/maps/a/vertices", map), 200);
  EXPECT_EQ(status("/v1/maps/a", "*"), 304);
}

// A folder may have been restored between them.
TEST_F(Conditional, AnotherServerHasOtherTags) {
  make_map("a", 0);
  const std::string here = tag("/v1/maps/a");
  ApiUnderTest other;
  other.post("/v1/maps", R"({"name":"a"})");
  EXPECT_NE(other.get("/v1/maps/a").header("ETag"), here);
}

TEST_F(Conditional, ImagesMasksAndVocabularies) {
  make_map("a", 0);
  api_.put("/v1/maps/a/mask", png(cv::Mat(240, 320, CV_8UC1, cv::Scalar(255))), "image/png");
  for (const char* path : {"/v1/maps/a/vertices/0/image", "/v1/maps/a/vertices/0/image?width=100", "/v1/maps/a/mask",
                           "/v1/vocabularies", "/v1/vocabularies/words", "/v1/openapi.json"}) {
    EXPECT_EQ(status(path, tag(path)), 304) << path;
    EXPECT_EQ(status(path, tag("/v1/maps/a")), 200) << path;
  }
  const std::string image = "/v1/maps/a/vertices/0/image";
  const std::set<std::string> tags = {tag(image), tag(image + "?width=100"), tag(image + "?width=101"),
                                      tag("/v1/maps/a/vertices/1/image")};
  EXPECT_EQ(tags.size(), 4u);
}

// What follows from more than a map's revision has no tag.
TEST_F(Conditional, NothingElseHasATag) {
  make_map("a", 0);
  for (const char* path : {"/v1/maps", "/v1/maps/a/pairs/0/1", "/v1/merges", "/healthz", "/metrics"}) {
    EXPECT_EQ(api_.get(path).header("ETag"), "") << path;
  }
}

}  // namespace
}  // namespace mapweld::test
