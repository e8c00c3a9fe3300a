#include "server/http/router.h"

#include <gtest/gtest.h>

#include "client/contract/problem.h"
#include "server/http/message.h"

namespace mapweld::server {
namespace {

Router example() {
  Router router;
  router.add({.method = "GET", .pattern = "/v1/maps"});
  router.add({.method = "POST", .pattern = "/v1/maps"});
  router.add({.method = "GET", .pattern = "/v1/maps/{map}"});
  router.add({.method = "GET", .pattern = "/v1/maps/{map}/vertices/{vertex}"});
  return router;
}

TEST(Router, FindsTheRouteAndDecodesItsParameters) {
  const Router router = example();
  const Router::Match match = router.match("GET", "/v1/maps/lab%20a/vertices/7");
  ASSERT_NE(match.route, nullptr);
  EXPECT_EQ(match.route->pattern, "/v1/maps/{map}/vertices/{vertex}");
  EXPECT_EQ(match.parameters.at("map"), "lab a");
  EXPECT_EQ(match.parameters.at("vertex"), "7");
}

TEST(Router, AnEncodedSlashDoesNotSeparate) {
  const Router router = example();
  const Router::Match match = router.match("GET", "/v1/maps/a%2Fvertices%2F1");
  ASSERT_NE(match.route, nullptr);
  EXPECT_EQ(match.route->pattern, "/v1/maps/{map}");
  EXPECT_EQ(match.parameters.at("map"), "a/vertices/1");
}

TEST(Router, HeadIsServedByGet) {
  const Router router = example();
  ASSERT_NE(router.match("HEAD", "/v1/maps").route, nullptr);
}

TEST(Router, TellsUnknownPathsFromUnknownMethods) {
  const Router router = example();
  EXPECT_EQ(router.match("GET", "/v1/map").allow, "");
  EXPECT_EQ(router.match("GET", "/v1/maps/").allow, "");
  EXPECT_EQ(router.match("GET", "/v1/maps/a/b").allow, "");
  EXPECT_EQ(router.match("GET", "/v1/maps/%zz").allow, "");
  EXPECT_EQ(router.match("DELETE", "/v1/maps").allow, "GET, HEAD, POST, OPTIONS");
  EXPECT_EQ(router.match("DELETE", "/v1/maps").route, nullptr);
}

TEST(Query, ReadsTypedValues) {
  const Query query(parse_query("limit=7&name=a+b%2Bc&verified=true&empty=&bare"));
  EXPECT_EQ(query.integer("limit", 1, 1000), 7);
  EXPECT_EQ(query.text("name"), "a b+c");
  EXPECT_EQ(query.boolean("verified"), true);
  EXPECT_EQ(query.text("empty"), "");
  EXPECT_EQ(query.text("bare"), "");
  EXPECT_EQ(query.text("absent"), std::nullopt);
  EXPECT_EQ(query.integer("absent", 0, 1), std::nullopt);
}

TEST(Query, RefusesWhatDoesNotFit) {
  const auto code = [](const std::function<void()>& call) -> std::string {
    try {
      call();
    } catch (const contract::ContractError& error) {
      return std::string(error.code().word());
    }
    return "none";
  };
  const Query query(parse_query("limit=0&big=99999999999999999999&text=7x&twice=1&twice=1&verified=yes"));
  for (const char* name : {"limit", "big", "text", "twice", "verified"}) {
    EXPECT_EQ(code([&] { query.integer(name, 1, 1000); }), "invalid_parameter") << name;
  }
  EXPECT_EQ(code([&] { query.boolean("verified"); }), "invalid_parameter");
  const std::vector<std::string> known = {"limit", "big", "text", "twice"};
  EXPECT_EQ(code([&] { query.refuse_unknown(known); }), "unknown_field");
  EXPECT_EQ(code([&] { parse_query("a=%4"); }), "malformed_request");
  EXPECT_EQ(code([&] { parse_query("a=%4g"); }), "malformed_request");
}

}  // namespace
}  // namespace mapweld::server
