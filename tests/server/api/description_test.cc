// What the pages say of the API is what there is.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/support/api_under_test.h"

namespace mapweld::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Every path of the router is in openapi.json and the other way round, with its method, the role that it asks for and
// its query parameters.
TEST(ApiDescription, OpenapiDescribesWhatThereIs) {
  ApiUnderTest api;
  const contract::Json document = api.get("/v1/openapi.json").json();
  EXPECT_THAT(document["openapi"].get<std::string>(), StartsWith("3.1"));
  std::set<std::string> described;
  for (const auto& [path, operations] : document["paths"].items()) {
    for (const auto& [method, operation] : operations.items()) {
      std::string upper = method;
      std::transform(upper.begin(), upper.end(), upper.begin(), ::toupper);
      std::set<std::string> query;
      if (operation.contains("parameters")) {
        for (const auto& listed : operation["parameters"]) {
          const contract::Json& parameter =
              listed.contains("$ref")
                  ? document[contract::Json::json_pointer(listed["$ref"].get<std::string>().substr(1))]
                  : listed;
          if (parameter["in"] == "query") query.insert(parameter["name"].get<std::string>());
        }
      }
      std::string line = upper + " " + path;
      for (const auto& way : operation.at("security")) line += " (" + way.at("key").at(0).get<std::string>() + ")";
      for (const std::string& name : query) line += " " + name;
      described.insert(line);
    }
  }
  std::set<std::string> routed;
  for (const server::Route& route : api.routes()) {
    std::string line = route.method + " " + route.pattern;
    if (route.role != server::Role::kAnybody) line += " (" + std::string(to_string(route.role)) + ")";
    for (const std::string& name : std::set<std::string>(route.query.begin(), route.query.end())) line += " " + name;
    routed.insert(line);
  }
  EXPECT_EQ(described, routed);
}

// docs/calls.md shows every path with its method.
TEST(ApiDescription, EveryCallHasAnExample) {
  ApiUnderTest api;
  server::Router router;
  std::set<std::string> routed;
  for (const server::Route& route : api.routes()) {
    routed.insert(route.method + " " + route.pattern);
    router.add(route);
  }
  std::ifstream in(MAPWELD_SOURCE_DIR "/docs/calls.md");
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const std::regex call(R"(curl [^\n]*?\$S(/[^\s"?)]*)[^\n]*)");
  std::set<std::string> shown;
  for (std::sregex_iterator found(page.begin(), page.end(), call), end; found != end; ++found) {
    const std::string line = found->str();
    const std::string path = std::regex_replace((*found)[1].str(), std::regex(R"(\$\w+)"), "1");
    std::smatch named;
    std::string method = "GET";
    if (std::regex_search(line, std::regex(" (-d|--data-binary|-F|.-F) "))) method = "POST";
    if (line.find("/batch ") != std::string::npos) method = "POST";
    if (std::regex_search(line, named, std::regex(" -X ([A-Z]+)"))) method = named[1];
    const server::Router::Match match = router.match(method, path);
    ASSERT_NE(match.route, nullptr) << line;
    shown.insert(method + " " + match.route->pattern);
  }
  EXPECT_EQ(shown, routed);
}

// /docs is one file that asks for openapi.json and nothing else, and the browser is told so.
TEST(ApiDescription, TheDocsPageNeedsNothingFromElsewhere) {
  ApiUnderTest api;
  const Answer page = api.get("/docs");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.header("Content-Type"), "text/html; charset=utf-8");
  EXPECT_FALSE(std::regex_search(page.body, std::regex(R"((src|href)="?(https?:)?//|@import|url\()")));
  EXPECT_THAT(page.body, HasSubstr("fetch('/v1/openapi.json')"));
  const std::string policy = page.header("Content-Security-Policy");
  EXPECT_THAT(policy, StartsWith("default-src 'none'; style-src 'sha256-"));
  EXPECT_THAT(policy, Not(HasSubstr("unsafe")));
  EXPECT_THAT(policy, HasSubstr("connect-src 'self'"));
}

// docs/http-api.md lists every code with its status.
TEST(ApiDescription, TheCodePageIsComplete) {
  std::ifstream in(MAPWELD_SOURCE_DIR "/docs/http-api.md");
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  for (const contract::CodeEntry& entry : contract::kCodes) {
    const std::string row = "| " + std::to_string(entry.status) + " | `" + std::string(entry.code) + "` |";
    EXPECT_THAT(page, HasSubstr(row));
  }
}

}  // namespace
}  // namespace mapweld::test
