// Cursors are for the list that gave them, and for nobody to make.
#include "server/api/cursors.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

class CursorsTest : public ::testing::Test {
 protected:
  CursorsTest() {
    for (const char* map : {"a", "b", "c"}) {
      api_.post("/v1/maps", std::string(R"({"name":")") + map + R"("})");
      for (int step = 0; step < 3; ++step) {
        api_.post_image(std::string("/v1/maps/") + map + "/images?name=" + std::to_string(step), photo_jpeg(1, step));
      }
    }
  }
  std::string cursor(const std::string& list) { return api_.get(list).json()["next_cursor"]; }
  std::string code(const std::string& list, const std::string& cursor) {
    return api_.get(list + "&cursor=" + cursor).code();
  }
  ApiUnderTest api_;
};

TEST_F(CursorsTest, GoOnInTheirListWhateverTheSizeOfItsPages) {
  for (const char* list : {"/v1/maps?limit=1", "/v1/maps/a/vertices?limit=1", "/v1/maps/a/edges?kind=inner&limit=1"}) {
    const contract::Json first = api_.get(list).json();
    const std::string next = list + ("&cursor=" + first["next_cursor"].get<std::string>());
    const contract::Json second = api_.get(next).json();
    EXPECT_EQ(second["items"].size(), 1u) << list;
    EXPECT_NE(second["items"], first["items"]) << list;
    const std::string larger = next.substr(0, next.find("limit=1")) + "limit=2" + next.substr(next.find("limit=1") + 7);
    EXPECT_EQ(api_.get(larger).json()["items"][0], second["items"][0]) << list;
  }
}

TEST_F(CursorsTest, AreRefusedElsewhere) {
  const std::string vertices = cursor("/v1/maps/a/vertices?limit=1");
  EXPECT_EQ(code("/v1/maps/a/vertices?limit=1", vertices), "");
  EXPECT_EQ(code("/v1/maps/b/vertices?limit=1", vertices), "invalid_parameter");
  EXPECT_EQ(code("/v1/maps/a/ignored?limit=1", vertices), "invalid_parameter");
  EXPECT_EQ(code("/v1/maps/a/vertices?name=1", vertices), "invalid_parameter");
  EXPECT_EQ(code("/v1/maps?limit=1", vertices), "invalid_parameter");
  const std::string edges = cursor("/v1/maps/a/edges?limit=1&confirmed=true");
  EXPECT_EQ(code("/v1/maps/a/edges?confirmed=true", edges), "");
  EXPECT_EQ(code("/v1/maps/a/edges?confirmed=false", edges), "invalid_parameter");
  EXPECT_EQ(code("/v1/maps/a/edges?limit=1", edges), "invalid_parameter");
  ApiUnderTest other;  // with a secret of its own
  EXPECT_EQ(other.get("/v1/maps?cursor=" + cursor("/v1/maps?limit=1")).code(), "invalid_parameter");
}

TEST_F(CursorsTest, CannotBeMadeOrChanged) {
  const std::string list = "/v1/maps?limit=1";
  const std::string good = cursor(list);
  ASSERT_EQ(code(list, good), "");
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string changed = good;
    changed[i] = changed[i] == '2' ? '3' : '2';
    EXPECT_EQ(code(list, changed), "invalid_parameter") << changed;
    EXPECT_EQ(code(list, good.substr(0, i)), "invalid_parameter") << i;
  }
  for (const std::string& bad : {std::string("1"), std::string("."), good + "0", "0" + good, good + "." + good}) {
    EXPECT_EQ(code(list, bad), "invalid_parameter") << bad;
  }
}

TEST_F(CursorsTest, TheSecretStaysWithTheDatabase) {
  const server::Cursors again(api_.services().store());
  const auto page = [](const server::PageRequest&) {
    contract::Page<contract::Map> page;
    page.next_cursor = "1";
    return page;
  };
  server::Request request;
  request.path = "/v1/maps";
  EXPECT_EQ(contract::parse_json(again.reply(request, page).body)["next_cursor"], cursor("/v1/maps?limit=1"));
}

}  // namespace
}  // namespace mapweld::test
