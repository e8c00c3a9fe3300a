// Who may do what, over HTTP, on every route that there is.
#include <map>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "server/access/access_gate.h"
#include "tests/server/access/keys_under_test.h"
#include "tests/server/http/raw_client.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using contract::Json;
using server::Role;

class AccessApi : public ::testing::Test {
 protected:
  AccessApi()
      : ring_(keys_.folder()),
        gate_(ring_, {.refused_per_address = {}}, server::LogFormat::kText),
        api_({}, {}, &gate_) {}

  // Names in the list under `path`, with `key`.
  std::string names(const std::string& path, const std::string& key, const char* field) const {
    std::string names;
    const Json page = api_.ask("GET", path, bearer(key)).json();
    for (const Json& item : page["items"]) {
      names += (names.empty() ? "" : " ") + item[field].get<std::string>();
    }
    return names;
  }

  KeysUnderTest keys_;
  server::KeyRing ring_;
  server::AccessGate gate_;
  ApiUnderTest api_;
};

TEST_F(AccessApi, EachRoleOpensItsRoutesAndNoOther) {
  std::map<Role, std::string> key_of;
  for (const Role role : {Role::kRead, Role::kWrite, Role::kOperate, Role::kAdmin}) {
    key_of[role] = keys_.make(std::string(to_string(role)), std::string(to_string(role)));
  }
  int changing = 0;
  for (const server::Route& route : api_.routes()) {
    const std::string path = std::regex_replace(route.pattern, std::regex(R"(\{\w+\})"), "7");
    const std::string what = route.method + " " + path;
    if (route.method != "GET" && path.find("localize") == std::string::npos) {
      ++changing;
      EXPECT_GT(route.role, Role::kRead) << what;
    }
    const Answer without = api_.ask(route.method, path);
    EXPECT_EQ(without.status == 401, route.role != Role::kAnybody) << what;
    EXPECT_EQ(api_.ask(route.method, path, bearer("mw_wrong")).status == 401, route.role != Role::kAnybody) << what;
    for (const auto& [role, key] : key_of) {
      if (path == "/v1/events" && role >= route.role) continue;  // is answered without an end
      const Answer answer = api_.ask(route.method, path, bearer(key));
      EXPECT_EQ(answer.status == 403, role < route.role) << what << " by " << to_string(role);
      EXPECT_NE(answer.status, 401) << what << " by " << to_string(role);
      EXPECT_EQ(answer.code() == "forbidden", role < route.role) << what << " by " << to_string(role);
    }
  }
  EXPECT_GE(changing, 14);
}

TEST_F(AccessApi, AKeyForSomeMapsSeesAndMergesThoseOnly) {
  const std::string all = keys_.make("all", "admin");
  const std::string lab = keys_.make("lab", "operate", "lab-*");
  for (const char* map : {"hall-a", "lab-a", "hall-b", "lab-b", "lab-c"}) {
    api_.services().create_map(map);
    api_.services().upload(map, "0", photo_jpeg(1, 0));
  }
  EXPECT_EQ(names("/v1/maps", lab, "name"), "lab-a lab-b lab-c");
  EXPECT_EQ(names("/v1/maps", all, "name"), "hall-a lab-a hall-b lab-b lab-c");
  const Json page = api_.ask("GET", "/v1/maps?limit=2", bearer(lab)).json();
  EXPECT_EQ(page["items"][1]["name"], "lab-b");
  const Json rest =
      api_.ask("GET", "/v1/maps?limit=2&cursor=" + page["next_cursor"].get<std::string>(), bearer(lab)).json();
  EXPECT_EQ(rest["items"].size(), 1u);
  EXPECT_EQ(rest["items"][0]["name"], "lab-c");
  EXPECT_TRUE(rest["next_cursor"].is_null());

  for (const char* path : {"/v1/maps/hall-a", "/v1/maps/hall%2Da", "/v1/maps/hall-a/graph", "/v1/maps/no-such-map"}) {
    EXPECT_EQ(api_.ask("GET", path, bearer(lab)).code(), "forbidden") << path;
  }
  EXPECT_EQ(api_.ask("POST", "/v1/maps/hall-a/localize", bearer(lab), photo_jpeg(1, 0)).code(), "forbidden");
  EXPECT_EQ(api_.ask("POST", "/v1/maps/lab-a/localize", bearer(lab), photo_jpeg(1, 0)).status, 200);
  EXPECT_EQ(api_.ask("POST", "/v1/maps", bearer(lab), R"({"name":"hall-c"})").code(), "forbidden");
  EXPECT_EQ(api_.ask("POST", "/v1/maps", bearer(lab), R"({"name":"lab-d"})").status, 201);
  EXPECT_EQ(api_.ask("PATCH", "/v1/maps/lab-d", bearer(lab), R"({"name":"hall-d"})").code(), "forbidden");
  EXPECT_EQ(api_.ask("PATCH", "/v1/maps/hall-a", bearer(lab), R"({"name":"lab-h"})").code(), "forbidden");
  EXPECT_EQ(api_.ask("PATCH", "/v1/maps/lab-d", bearer(lab), R"({"name":"lab-e"})").status, 200);

  const auto merge = [&](const std::string& key, const std::string& body) {
    return api_.ask("POST", "/v1/merges", bearer(key), body);
  };
  EXPECT_EQ(merge(lab, R"({"maps":["lab-a","hall-a"],"name":"lab-x"})").code(), "forbidden");
  EXPECT_EQ(merge(lab, R"({"maps":["lab-a","lab-b"],"name":"mine"})").code(), "forbidden");
  EXPECT_EQ(merge(all, R"({"maps":["hall-a","hall-b"],"name":"hall"})").status, 202);
  EXPECT_EQ(merge(lab, R"({"maps":["lab-a","lab-b"],"name":"lab-ab"})").status, 202);
  EXPECT_EQ(names("/v1/merges", lab, "map"), "lab-ab");
  EXPECT_EQ(names("/v1/merges", all, "map"), "hall lab-ab");
  for (const char* verb : {"", "/curve", "/edges", "/pairs/0/1"}) {
    EXPECT_EQ(api_.ask("GET", std::string("/v1/merges/1") + verb, bearer(lab)).code(), "forbidden") << verb;
    EXPECT_NE(api_.ask("GET", std::string("/v1/merges/2") + verb, bearer(lab)).status, 403) << verb;
  }
  for (const char* verb : {"/pause", "/resume", "/restart", "/cancel"}) {
    EXPECT_EQ(api_.ask("POST", std::string("/v1/merges/1") + verb, bearer(lab)).code(), "forbidden") << verb;
  }
  EXPECT_EQ(api_.ask("DELETE", "/v1/merges/1", bearer(lab)).code(), "forbidden");
  EXPECT_EQ(api_.ask("GET", "/v1/merges/99", bearer(lab)).code(), "no_such_merge");
}

TEST_F(AccessApi, APageFromElsewhereChangesNothing) {
  const httplib::Headers evil = {{"Origin", "http://evil.example"}, {"Content-Type", "text/plain"}};
  EXPECT_EQ(api_.ask("POST", "/v1/maps", evil, R"({"name":"a"})").code(), "forbidden");
  EXPECT_EQ(api_.ask("GET", "/v1/maps", evil).header("Access-Control-Allow-Origin"), "");
  const std::string own = "http://127.0.0.1:" + std::to_string(api_.port());
  EXPECT_EQ(api_.ask("POST", "/v1/maps", {{"Origin", own}}, R"({"name":"a"})").status, 201);
  EXPECT_EQ(api_.ask("POST", "/v1/maps", {{"Content-Type", "text/plain"}}, R"({"name":"b"})").status, 201);
}

TEST_F(AccessApi, EventsTellAKeyOfItsMapsOnly) {
  api_.services().create_map("lab-a");
  const std::string admin = keys_.make("all", "admin");
  const std::string some = keys_.make("some", "read", "lab-*");
  RawClient raw(api_.port());
  raw.send("GET /v1/events HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer " + some + "\r\n\r\n");
  while (raw.receive_some().find(": mapweld") == std::string::npos) continue;
  for (const char* map : {"secret", "lab-b"}) {
    EXPECT_EQ(api_.ask("DELETE", "/v1/maps/" + std::string(map), bearer(admin)).status, 404);
    api_.services().create_map(map);
    EXPECT_EQ(api_.ask("DELETE", "/v1/maps/" + std::string(map), bearer(admin)).status, 204);
  }
  std::string heard;
  while (heard.find("lab-b") == std::string::npos) {
    const std::string some_more = raw.receive_some();
    ASSERT_NE(some_more, "timeout");
    heard += some_more;
  }
  EXPECT_EQ(heard.find("secret"), std::string::npos);
}

}  // namespace
}  // namespace mapweld::test
