// What a map is made to keep, show and forget, over loopback: its mask, its name, its images.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "client/contract/json.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using ::testing::HasSubstr;

TEST(MapChanges, AnImageCanBeHadSmaller) {
  ApiUnderTest api;
  api.post("/v1/maps", R"({"name":"a"})");
  api.post_image("/v1/maps/a/images", photo_jpeg(1, 0));
  api.post_image("/v1/maps/a/images", png(photo(2, 0)));
  for (const auto& [vertex, type] : {std::pair{"0", "image/jpeg"}, std::pair{"1", "image/png"}}) {
    const std::string path = std::string("/v1/maps/a/vertices/") + vertex + "/image";
    const Answer small = api.get(path + "?width=64");
    EXPECT_EQ(small.header("Content-Type"), type);
    const std::vector<std::uint8_t> bytes(small.body.begin(), small.body.end());
    EXPECT_EQ(cv::imdecode(bytes, cv::IMREAD_COLOR).size(), cv::Size(64, 48));
    EXPECT_EQ(api.get(path + "?width=320").body, api.get(path).body);
    for (const char* width : {"15", "4097", "-1", "x", ""}) {
      const Answer refused = api.get(path + "?width=" + width);
      EXPECT_EQ(refused.status, 422) << width;
      EXPECT_EQ(refused.code(), "invalid_parameter") << width;
    }
  }
}

TEST(MapChanges, AMapsMask) {
  ApiUnderTest api;
  api.services().create_map("a");
  api.services().create_map("b");
  const std::string mask = png(cv::Mat(6, 8, CV_8UC1, cv::Scalar(255)));
  const Answer set = api.put("/v1/maps/a/mask", mask, "image/png");
  EXPECT_EQ(set.status, 204);
  EXPECT_EQ(set.body, "");
  const Answer got = api.get("/v1/maps/a/mask");
  EXPECT_EQ(got.status, 200);
  EXPECT_EQ(got.header("Content-Type"), "image/png");
  EXPECT_EQ(got.body, mask);
  const contract::Json map = api.get("/v1/maps/a").json();
  EXPECT_EQ(map["mask"]["width_px"], 8);
  EXPECT_EQ(map["mask"]["used_share"], 1.0);
  EXPECT_EQ("\"" + map["mask"]["sha256"].get<std::string>() + "\"", got.header("ETag"));
  EXPECT_FALSE(api.get("/v1/maps/b").json().contains("mask"));

  api.post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})");
  EXPECT_EQ(api.put("/v1/maps/ab/mask", mask, "image/png").code(), "map_is_merged");
  EXPECT_EQ(api.del("/v1/maps/ab/mask").code(), "map_is_merged");
  EXPECT_EQ(api.get("/v1/maps/ab/mask").code(), "no_such_mask");
  EXPECT_EQ(api.put("/v1/maps/x/mask", mask, "image/png").code(), "no_such_map");
  EXPECT_EQ(api.put("/v1/maps/b/mask", photo_jpeg(1, 0), "image/png").code(), "unsupported_image");

  EXPECT_EQ(api.del("/v1/maps/a/mask").status, 204);
  EXPECT_EQ(api.get("/v1/maps/a/mask").status, 404);
  EXPECT_EQ(api.del("/v1/maps/a/mask").status, 204) << "as asked: there is none";
}

TEST(MapChanges, ImagesAreDeletedAndRestored) {
  ApiUnderTest api;
  api.post("/v1/maps", R"({"name":"lab"})");
  for (int step = 0; step < 4; ++step) {
    api.post_image("/v1/maps/lab/images?name=" + std::to_string(step) + ".jpg", photo_jpeg(1, step));
  }
  const std::string before = api.get("/v1/maps/lab/graph").body;
  const Answer one = api.del("/v1/maps/lab/vertices/1");
  EXPECT_EQ(one.status, 200);
  EXPECT_EQ(one.body, R"({"deleted":1})");
  EXPECT_EQ(api.get("/v1/maps/lab/vertices/1").code(), "no_such_vertex");
  EXPECT_THAT(api.get("/v1/maps/lab/vertices/1").json()["detail"].get<std::string>(), HasSubstr("deleted"));
  EXPECT_EQ(api.get("/v1/maps/lab/vertices/1/image").code(), "no_such_vertex");
  EXPECT_EQ(api.del("/v1/maps/lab/vertices/1").code(), "no_such_vertex");
  EXPECT_EQ(api.del("/v1/maps/lab/vertices?name=3.jpg").body, R"({"deleted":1})");
  EXPECT_EQ(api.del("/v1/maps/lab/vertices?from=0&to=9").body, R"({"deleted":2})");
  EXPECT_EQ(api.get("/v1/maps/lab").json()["vertices"], 0);
  EXPECT_EQ(api.get("/v1/maps/lab").json()["edges"], 0);
  EXPECT_TRUE(api.get("/v1/maps/lab/quality").json()["components"] == 0);
  for (const char* query : {"", "?from=1", "?to=1", "?name=0.jpg&from=0&to=1", "?from=3&to=1"}) {
    EXPECT_EQ(api.del(std::string("/v1/maps/lab/vertices") + query).code(), "invalid_parameter") << query;
  }
  EXPECT_EQ(api.del("/v1/maps/none/vertices/1").code(), "no_such_map");
  for (const char* vertex : {"2", "0", "1", "3"}) {
    const Answer restored = api.post(std::string("/v1/maps/lab/vertices/") + vertex + "/restore", "");
    EXPECT_EQ(restored.status, 200);
    EXPECT_EQ(restored.json()["vertex"], std::stoi(vertex));
  }
  EXPECT_EQ(api.get("/v1/maps/lab/graph").body, before);
  EXPECT_EQ(api.post("/v1/maps/lab/vertices/4/restore", "").code(), "no_such_vertex");
  EXPECT_EQ(api.del("/v1/maps/lab/vertices/2/image").status, 204);
  EXPECT_EQ(api.get("/v1/maps/lab/vertices/2/image").code(), "no_such_image");
  EXPECT_EQ(api.get("/v1/maps/lab/vertices/2").status, 200);
}

TEST(MapChanges, AMapIsRenamed) {
  ApiUnderTest api;
  api.post("/v1/maps", R"({"name":"lab"})");
  const Answer renamed = api.ask("PATCH", "/v1/maps/lab", {}, R"({"name":"hall","labels":{"floor":"2"}})");
  EXPECT_EQ(renamed.status, 200);
  EXPECT_EQ(renamed.json(), api.get("/v1/maps/hall").json());
  EXPECT_EQ(renamed.json()["labels"]["floor"], "2");
  EXPECT_EQ(api.get("/v1/maps/lab").code(), "no_such_map");
  EXPECT_EQ(api.ask("PATCH", "/v1/maps/hall", {}, R"({"parameters":{"votes":"min"}})").status, 422);
}

}  // namespace
}  // namespace mapweld::test
