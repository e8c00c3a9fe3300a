// The examples of docs/http-api.md and README.md themselves: documents are ones of the contract, requests are taken.
#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "client/contract/backup.h"
#include "client/contract/graph.h"
#include "client/contract/image.h"
#include "client/contract/map.h"
#include "client/contract/merge.h"
#include "client/contract/pair.h"
#include "client/contract/problem_document.h"
#include "client/contract/quota.h"
#include "client/contract/route.h"
#include "client/contract/vocabulary.h"
#include "tests/server/support/api_under_test.h"

namespace mapweld::test {
namespace {

using contract::ContractError;
using contract::Json;

std::string page(const std::string& name) {
  std::ifstream in(MAPWELD_SOURCE_DIR "/" + name);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

// The JSON documents one after the other in a text; an ellipsis stands for nothing.
std::vector<std::string> documents_in(std::string text) {
  for (const auto& [from, to] : {std::pair("{…}", "{}"), std::pair("[…]", "[]"), std::pair(", …]", "]")}) {
    replace_all(text, from, to);
  }
  std::vector<std::string> documents;
  int depth = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '{' && depth++ == 0) begin = i;
    if (text[i] == '}' && --depth == 0) documents.push_back(text.substr(begin, i + 1 - begin));
  }
  return documents;
}

// Those in the page's ```json blocks.
std::vector<std::string> documents_of(const std::string& text) {
  const std::string fence = "```json\n";
  std::vector<std::string> all;
  for (std::size_t at = 0; (at = text.find(fence, at)) != std::string::npos;) {
    at += fence.size();
    const std::vector<std::string> some = documents_in(text.substr(at, text.find("```", at) - at));
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

// The bodies that curl is given for a path.
std::vector<std::string> bodies_for(const std::string& text, const std::string& path) {
  std::vector<std::string> bodies;
  const std::string before = path + " -d '";
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
    at += before.size();
    bodies.push_back(text.substr(at, text.find('\'', at) - at));
  }
  return bodies;
}

// Has a T all of the document's fields, and every value its type?
template <class T>
bool fits(const Json& document) {
  try {
    contract::read_request<T>(document);
    return true;
  } catch (const ContractError&) {
    return false;
  }
}

template <class... T>
bool fits_any(const Json& document) {
  return (fits<T>(document) || ...);
}

bool is_submission(const Json& document) { return document.contains("maps") && !document.contains("id"); }

TEST(DocumentedExamples, AreDocumentsOfTheContract) {
  using namespace contract;
  const std::vector<std::string> examples = documents_of(page("docs/http-api.md"));
  EXPECT_GE(examples.size(), 14u);
  for (const std::string& text : examples) {
    const Json example = parse_json(text);
    const bool known =
        fits_any<contract::Vocabulary, Backup, Map, Upload, Vertex, IgnoredImage, contract::Localization,
                 contract::Edge, Quality, contract::Route, SubmitMerge, Merge, Pair, contract::Quota, contract::Problem>(example);
    EXPECT_TRUE(known) << text;
    if (!is_submission(example)) continue;
    EXPECT_NO_THROW(check(read_request<SubmitMerge>(example))) << text;
  }
  EXPECT_EQ(std::ranges::count_if(examples, [](const std::string& e) { return is_submission(parse_json(e)); }), 1);
}

// Each on a server of its own, as it stands on the page.
TEST(DocumentedExamples, AreTakenByTheServer) {
  std::vector<std::string> maps, merges;
  for (const std::string& example : documents_of(page("docs/http-api.md"))) {
    if (is_submission(contract::parse_json(example))) merges.push_back(example);
  }
  for (const char* name : {"docs/http-api.md", "README.md"}) {
    for (const std::string& body : bodies_for(page(name), "/v1/maps")) maps.push_back(body);
    for (const std::string& body : bodies_for(page(name), "/v1/merges")) merges.push_back(body);
  }
  EXPECT_GE(maps.size(), 3u);
  EXPECT_GE(merges.size(), 3u);
  for (const std::string& body : maps) {
    const ApiUnderTest api;
    EXPECT_EQ(api.post("/v1/maps", body).status, 201) << body;
  }
  for (const std::string& body : merges) {
    ApiUnderTest api;
    for (const char* name : {"lab-a", "lab-b"}) api.services().create_map(name);
    const Answer answer = api.post("/v1/merges", body);
    EXPECT_EQ(answer.status, 202) << body << "\n" << answer.body;
    // What was asked for is what is shown.
    const Json asked = contract::parse_json(body).value("parameters", Json::object());
    for (const auto& [key, value] : asked.items()) EXPECT_EQ(answer.json()["parameters"][key], value) << key;
  }
}

}  // namespace
}  // namespace mapweld::test
