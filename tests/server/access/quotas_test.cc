// What a key may have, over HTTP: nothing is stored beyond it, and deleting gives back.
#include <future>
#include <latch>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/access/access_gate.h"
#include "tests/server/access/keys_under_test.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using contract::Json;

class Quotas : public ::testing::Test {
 protected:
  Quotas() : ring_(keys_.folder()), gate_(ring_, {}, server::LogFormat::kText), api_({}, {}, &gate_) {}

  Answer post(const std::string& key, const std::string& path, const std::string& body = "") const {
    return api_.ask("POST", path, bearer(key), body);
  }
  Answer upload(const std::string& key, const std::string& map, std::uint64_t wall, int step = 0) const {
    return post(key, "/v1/maps/" + map + "/images", photo_jpeg(wall, step));
  }
  Json quota(const std::string& key) const { return api_.ask("GET", "/v1/quota", bearer(key)).json(); }
  std::string state() { return dump_store(api_.services().store()); }

  KeysUnderTest keys_;
  server::KeyRing ring_;
  server::AccessGate gate_;
  ApiUnderTest api_;
};

TEST_F(Quotas, WithoutKeysNobodyHasAny) {
  api_.services().create_map("lab");
  EXPECT_EQ(api_.post_image("/v1/maps/lab/images", photo_jpeg(1, 0)).status, 201);
  EXPECT_EQ(api_.get("/v1/quota").json(), contract::parse_json(R"({"key":null,"images":{"used":0,"max":null},
      "bytes":{"used":0,"max":null},"queued_merges":{"used":0,"max":null}})"));
}

TEST_F(Quotas, ImagesBeyondAreRefusedAndDeletingGivesBack) {
  const std::string key = keys_.make("robot", "write", "*", {.images = 2});
  const std::string other = keys_.make("other", "write");
  post(key, "/v1/maps", R"({"name":"lab"})");
  EXPECT_EQ(upload(key, "lab", 1).status, 201);
  EXPECT_EQ(upload(key, "lab", 2).status, 201);
  const std::string before = state();
  const Answer refused = upload(key, "lab", 3);
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(refused.code(), "quota_exceeded");
  EXPECT_EQ(refused.json()["detail"],
            "The key \"robot\" has 2 of 2 images; this would be more. Delete some, or ask for a larger quota.");
  EXPECT_EQ(state(), before);
  EXPECT_EQ(upload(other, "lab", 3).status, 201);
  EXPECT_EQ(upload(key, "lab", 1).code(), "quota_exceeded") << "an ignored image is one as well";
  EXPECT_EQ(quota(key)["images"], contract::parse_json(R"({"used":2,"max":2})"));
  EXPECT_EQ(quota(other)["images"], contract::parse_json(R"({"used":1,"max":null})"));

  EXPECT_EQ(api_.ask("DELETE", "/v1/maps/lab/vertices/0", bearer(other)).status, 200);
  EXPECT_EQ(upload(key, "lab", 4).status, 201);
  EXPECT_EQ(post(key, "/v1/maps/lab/vertices/0/restore").code(), "quota_exceeded");
  EXPECT_EQ(post(other, "/v1/maps/lab/vertices/0/restore").status, 200);
  EXPECT_EQ(quota(other)["images"]["used"], 2);
  keys_.set_quota("robot", {.images = 3});
  EXPECT_EQ(upload(key, "lab", 5).status, 201);
  EXPECT_EQ(api_.ask("DELETE", "/v1/maps/lab", bearer(other)).status, 204);
  EXPECT_EQ(quota(key)["images"]["used"], 0);
}

TEST_F(Quotas, BytesThatAreKeptCount) {
  const std::string image = photo_jpeg(1, 0);
  const auto bytes = static_cast<std::int64_t>(image.size());
  const std::string key = keys_.make("robot", "write", "*", {.bytes = bytes});
  post(key, "/v1/maps", R"({"name":"lab"})");
  post(key, "/v1/maps", R"({"name":"words","parameters":{"store_images":"none"}})");
  EXPECT_EQ(upload(key, "words", 2).status, 201);
  EXPECT_EQ(upload(key, "lab", 1).status, 201);
  EXPECT_EQ(quota(key)["bytes"]["used"], bytes);
  EXPECT_EQ(upload(key, "lab", 2).code(), "quota_exceeded");
  EXPECT_EQ(upload(key, "words", 3).status, 201);
  EXPECT_EQ(upload(key, "lab", 1).status, 200) << "the same bytes are kept once";
  EXPECT_EQ(api_.ask("DELETE", "/v1/maps/lab/vertices/0/image", bearer(key)).status, 204);
  EXPECT_EQ(quota(key)["bytes"]["used"], 0);
}

TEST_F(Quotas, ABatchSaysItImageByImage) {
  const std::string key = keys_.make("robot", "write", "*", {.images = 3});
  post(key, "/v1/maps", R"({"name":"lab"})");
  std::string body;
  for (const std::string& image : {photo_jpeg(1, 0), std::string("no image"), photo_jpeg(1, 1), photo_jpeg(1, 2),
                                   photo_jpeg(1, 3), photo_jpeg(1, 4)}) {
    body += "--b\r\nContent-Disposition: form-data; name=\"i\"\r\n\r\n" + image + "\r\n";
  }
  httplib::Headers headers = bearer(key);
  headers.emplace("Content-Type", "multipart/form-data; boundary=b");
  const Json items = api_.ask("POST", "/v1/maps/lab/images/batch", headers, body + "--b--\r\n").json()["items"];
  ASSERT_EQ(items.size(), 6u);
  for (const std::size_t i : {0, 2, 3}) EXPECT_EQ(items[i]["outcome"], "inserted") << i;
  for (const std::size_t i : {4, 5}) EXPECT_EQ(items[i]["code"], "quota_exceeded") << i;
  EXPECT_EQ(quota(key)["images"]["used"], 3);
  EXPECT_EQ(api_.ask("GET", "/v1/maps/lab", bearer(key)).json()["vertices"], 3);
  keys_.set_quota("robot", {});
  EXPECT_EQ(upload(key, "lab", 1, 3).status, 201) << "the map in memory is the one that is stored";
}

TEST_F(Quotas, TwoUploadsAtOnceAtTheEdgeAreOneTooMany) {
  const std::string key = keys_.make("robot", "write", "*", {.images = 0});
  constexpr int kMaps = 4;
  for (int i = 0; i < kMaps; ++i) post(key, "/v1/maps", R"({"name":"m)" + std::to_string(i) + "\"}");
  for (int round = 1; round <= 6; ++round) {
    keys_.set_quota("robot", {.images = round});
    std::latch start(kMaps);
    std::vector<std::future<Answer>> asked;
    for (int i = 0; i < kMaps; ++i) {
      asked.push_back(std::async(std::launch::async, [&, i] {
        start.arrive_and_wait();
        return upload(key, "m" + std::to_string(i), static_cast<std::uint64_t>(10 * round + i));
      }));
    }
    int stored = 0;
    for (auto& future : asked) {
      const Answer answer = future.get();
      stored += answer.status == 201 ? 1 : 0;
      EXPECT_EQ(answer.code(), answer.status == 201 ? "" : "quota_exceeded") << answer.body;
    }
    EXPECT_EQ(stored, 1);
    EXPECT_EQ(quota(key)["images"]["used"], round);
  }
}

TEST_F(Quotas, AMapThatIsImportedIsItsImporters) {
  const std::string admin = keys_.make("admin", "admin");
  const std::string small = keys_.make("small", "write", "*", {.images = 1});
  const std::string large = keys_.make("large", "write", "*", {.images = 2});
  post(admin, "/v1/maps", R"({"name":"lab"})");
  upload(admin, "lab", 1);
  upload(admin, "lab", 2);
  const std::string file = api_.ask("GET", "/v1/maps/lab/export", bearer(admin)).body;
  const std::string before = state();
  EXPECT_EQ(post(small, "/v1/maps:import?name=copy", file).code(), "quota_exceeded");
  EXPECT_EQ(state(), before);
  EXPECT_EQ(post(large, "/v1/maps:import?name=copy", file).status, 201);
  EXPECT_EQ(quota(large)["images"]["used"], 2);
}

TEST_F(Quotas, MergesThatWaitOrRunAreBounded) {
  const std::string admin = keys_.make("admin", "admin");
  const std::string none = keys_.make("none", "operate", "*", {.queued_merges = 0});
  const std::string one = keys_.make("one", "operate", "*", {.queued_merges = 1});
  for (const char* map : {"a", "b"}) {
    post(admin, "/v1/maps", R"({"name":")" + std::string(map) + "\"}");
    for (int step = 0; step < 3; ++step) upload(admin, map, 1, step);
  }
  const std::string before = state();
  const Answer refused = post(none, "/v1/merges", R"({"maps":["a","b"],"name":"ab"})");
  EXPECT_EQ(refused.code(), "quota_exceeded");
  EXPECT_EQ(refused.json()["detail"],
            "The key \"none\" has 0 of 0 merges that wait or run; this would be more. "
            "Delete some, or ask for a larger quota.");
  EXPECT_EQ(state(), before);
  EXPECT_EQ(post(one, "/v1/merges", R"({"maps":["a","b"],"name":"ab"})").status, 202);
  api_.services().jobs().wait(1, std::chrono::seconds(30));
  EXPECT_EQ(post(one, "/v1/merges", R"({"maps":["a","b"],"name":"again"})").status, 202) << "the first is at rest";
  api_.services().jobs().wait(2, std::chrono::seconds(30));
  EXPECT_EQ(quota(one)["queued_merges"]["used"], 0);
  EXPECT_EQ(post(none, "/v1/merges/1/restart").code(), "quota_exceeded");
  EXPECT_EQ(post(one, "/v1/merges/1/restart").status, 202);
}

}  // namespace
}  // namespace mapweld::test
