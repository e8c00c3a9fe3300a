// Robots upload, localize, read and merge at the same time. Meant to be run under ThreadSanitizer as well.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "schema/store_check.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

TEST(Concurrency, EverythingAtOnceLeavesAWholeStore) {
  ServicesOptions options;
  options.workers = 3;
  options.cache_bytes = 200'000;  // fewer than the maps need: they come and go while in use
  ApiUnderTest api({}, options);
  const std::vector<std::string> maps = {"a", "b", "c"};
  for (std::size_t i = 0; i < maps.size(); ++i) {
    api.services().create_map(maps[i]);
    api.services().upload(maps[i], "first", photo_jpeg(1, static_cast<int>(i)));
  }
  std::atomic<bool> uploading{true};
  std::atomic<int> bad{0};
  const auto expect = [&](const Answer& answer, std::initializer_list<int> allowed) {
    if (std::find(allowed.begin(), allowed.end(), answer.status) == allowed.end()) {
      ++bad;
      ADD_FAILURE() << answer.status << " " << answer.body;
    }
  };
  std::vector<std::thread> uploaders;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    uploaders.emplace_back([&, i] {
      std::vector<std::pair<std::string, std::string>> images;
      for (int step = 0; step < 8; ++step)
        images.emplace_back("step-" + std::to_string(step), photo_jpeg(1 + i / 2, step));
      expect(api.post_batch("/v1/maps/" + maps[i] + "/images/batch", images), {200});
      for (int step = 0; step < 4; ++step) {
        expect(api.post_image("/v1/maps/" + maps[i] + "/images?name=more-" + std::to_string(step),
                              photo_jpeg(7 + i, step)),
               {200, 201});
      }
    });
  }
  std::vector<std::thread> others;
  others.emplace_back([&] {
    for (int i = 0; uploading; ++i) {
      const std::string map = maps[static_cast<std::size_t>(i) % 3];
      expect(api.post_image("/v1/maps/" + map + "/localize", photo_jpeg(1, i % 8)), {200});
    }
  });
  others.emplace_back([&] {
    for (int i = 0; uploading; ++i) {
      const std::string map = maps[static_cast<std::size_t>(i) % 3];
      expect(api.get("/v1/maps/" + map + "/quality"), {200});
      expect(api.get("/v1/maps/" + map + "/graph?format=json"), {200});
      expect(api.get("/v1/maps/" + map + "/vertices"), {200});
      expect(api.get("/metrics"), {200});
    }
  });
  others.emplace_back([&] {
    for (int round = 0; uploading; ++round) {
      const std::string name = "merged-" + std::to_string(round);
      const Answer submitted = api.post("/v1/merges", R"({"maps":["a","b"],"name":")" + name + "\"}");
      expect(submitted, {202});
      if (submitted.status != 202) break;
      const std::string self = submitted.json()["links"]["self"];
      expect(api.post_image("/v1/maps/" + name + "/localize", photo_jpeg(1, 3)), {200});
      expect(api.get(self + "/curve"), {200});
      expect(api.get("/v1/maps/" + name + "/quality"), {200});
      expect(api.del(round % 2 == 0 ? self : "/v1/maps/" + name), {204});
    }
  });
  for (std::thread& thread : uploaders) thread.join();
  uploading = false;
  for (std::thread& thread : others) thread.join();
  EXPECT_EQ(bad, 0);
  for (const std::string& map : maps) {
    const contract::Json json = api.get("/v1/maps/" + map).json();
    EXPECT_EQ(json["vertices"].get<int>() + json["ignored"].get<int>(), 13) << map;
  }
  EXPECT_TRUE(check_store(api.services().store().read()).findings.empty());
}

}  // namespace
}  // namespace mapweld::test
