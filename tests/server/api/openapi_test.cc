// openapi.json: complete, kept, true to itself, and true to the checks of requests.
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "client/contract/map.h"
#include "client/contract/merge.h"
#include "client/contract/page.h"
#include "server/api/description/describe.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/described_api.h"

namespace mapweld::test {
namespace {

using nlohmann::json;

class OpenApi : public ::testing::Test {
 protected:
  const json& document() const { return described_.document(); }
  json resolved(const json& node) const {
    return node.contains("$ref") ? document().at(json::json_pointer(node["$ref"].get<std::string>().substr(1))) : node;
  }

  ApiUnderTest api_;
  DescribedApi described_{api_.routes()};
};

TEST_F(OpenApi, EverythingHasItsWordsAndNoWordIsLeftOver) {
  for (const std::string& fault : server::describe_api(api_.routes()).faults) ADD_FAILURE() << "words.json: " << fault;
}

// MAPWELD_WRITE_OPENAPI=1 writes the copy anew.
TEST_F(OpenApi, TheCommittedCopyIsWhatIsServed) {
  const std::string served = api_.get("/v1/openapi.json").body;
  const char* const file = MAPWELD_SOURCE_DIR "/docs/openapi.json";
  if (std::getenv("MAPWELD_WRITE_OPENAPI")) std::ofstream(file) << served;
  std::ifstream in(file);
  const std::string kept((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_TRUE(kept == served) << "docs/openapi.json is out of date: run this test with MAPWELD_WRITE_OPENAPI=1";
}

TEST_F(OpenApi, OperationsHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const server::Route& route : api_.routes()) {
    EXPECT_TRUE(names.insert(route.says.operation).second) << route.method << " " << route.pattern;
    EXPECT_FALSE(route.says.answers.empty()) << route.says.operation;
  }
}

TEST_F(OpenApi, ExamplesAreOfTheirSchemas) {
  int examples = 0;
  const auto look = [&](const json& content, const std::string& where) {
    if (!content.contains("examples")) return;
    for (const auto& [name, example] : content["examples"].items()) {
      ++examples;
      for (const std::string& fault : described_.faults(content["schema"], resolved(example)["value"])) {
        ADD_FAILURE() << where << ", " << name << ": " << fault;
      }
    }
  };
  for (const auto& [path, operations] : document()["paths"].items()) {
    for (const auto& [method, operation] : operations.items()) {
      if (operation.contains("requestBody")) {
        for (const json& content : operation["requestBody"]["content"]) look(content, method + " " + path);
      }
      for (const json& response : operation["responses"]) {
        for (const json& content : resolved(response).value("content", json::object())) {
          look(content, method + " " + path);
        }
      }
    }
  }
  EXPECT_GT(examples, 200);
}

TEST_F(OpenApi, PagesHaveTheLimitsOfTheCode) {
  const json& limit = document()["components"]["parameters"]["limit"]["schema"];
  EXPECT_EQ(limit["maximum"], contract::kMaxPageItems);
  EXPECT_EQ(limit["default"], contract::kDefaultPageItems);
}

// Says what values of a request's fields its schema takes and refuses, and whether `taken` agrees.
class RangeCheck {
 public:
  RangeCheck(std::function<json(const json&)> resolve, json request, std::function<bool(const json&)> taken)
      : resolve_(std::move(resolve)), request_(std::move(request)), taken_(std::move(taken)) {
    EXPECT_TRUE(taken_(request_)) << request_;
  }

  int fields(const json& schema, const json::json_pointer& at) {
    int bounds = 0;
    for (const auto& [name, field] : schema["properties"].items()) {
      const json plain = without_null(resolve_(field));
      bounds += plain.contains("properties") ? fields(plain, at / name) : field_bounds(plain, at / name);
    }
    return bounds;
  }

 private:
  json without_null(const json& schema) const {
    return schema.contains("oneOf") ? resolve_(schema["oneOf"][0]) : schema;
  }

  void expect(bool wanted, const json::json_pointer& at, const json& value) const {
    json request = request_;
    request[at] = value;
    EXPECT_EQ(taken_(request), wanted) << request;
  }

  int field_bounds(const json& field, const json::json_pointer& at) const {
    int bounds = 0;
    const auto bound = [&](const char* key, const std::function<void(const json&)>& look) {
      if (!field.contains(key)) return;
      ++bounds;
      look(field[key]);
    };
    const bool whole = field.dump().find("\"integer\"") != std::string::npos;
    const auto beside = [&](const json& value, int direction) {
      return whole ? json(value.get<std::int64_t>() + direction) : json(value.get<double>() + direction * 1e-3);
    };
    bound("minimum", [&](const json& least) {
      expect(true, at, least);
      expect(false, at, beside(least, -1));
    });
    bound("maximum", [&](const json& most) {
      expect(true, at, most);
      expect(false, at, beside(most, 1));
    });
    bound("exclusiveMinimum", [&](const json& below) {
      expect(false, at, below);
      expect(true, at, beside(below, 1));
    });
    bound("enum", [&](const json& words) {
      for (const json& word : words) expect(true, at, word);
      expect(false, at, "no such word");
    });
    bound("pattern", [&](const json&) { expect(false, at, "no slug"); });
    bound("format", [&](const json& format) {
      if (format == "uuid") expect(false, at, "no uuid");
    });
    bound("maxProperties", [&](const json& most) {
      json labels = json::object();
      for (int i = 0; i < most.get<int>(); ++i) labels["l" + std::to_string(i)] = "";
      expect(true, at, labels);
      labels["one more"] = "";
      expect(false, at, labels);
    });
    return bounds;
  }

  std::function<json(const json&)> resolve_;
  json request_;
  std::function<bool(const json&)> taken_;
};

template <class Request>
bool is_taken(const json& request) {
  try {
    check(contract::read_request<Request>(contract::parse_json(request.dump())));
    return true;
  } catch (const contract::ContractError&) {
    return false;
  }
}

TEST_F(OpenApi, RangesOfRequestsAreThoseOfTheirChecks) {
  const auto check_ranges = [&](const char* name, const json& request, std::function<bool(const json&)> taken) {
    SCOPED_TRACE(name);
    RangeCheck check([this](const json& node) { return resolved(node); }, request, std::move(taken));
    return check.fields(document()["components"]["schemas"][name], json::json_pointer());
  };
  EXPECT_GT(check_ranges("CreateMap", {{"name", "a"}}, is_taken<contract::CreateMap>), 15);
  const json camera = {{"model", "pinhole"}, {"fx_px", 500}, {"fy_px", 500}, {"cx_px", 320}, {"cy_px", 240}};
  const auto with_distortion = [](json request) {  // of as many numbers as the model has
    json& own = request["camera"];
    own["distortion"] = own["model"] == "pinhole" ? json::array() : json::array({0, 0, 0, 0});
    return is_taken<contract::ChangeMap>(request);
  };
  EXPECT_GT(check_ranges("ChangeMap", {{"camera", camera}}, with_distortion), 18);
  EXPECT_GT(check_ranges("SubmitMerge", {{"maps", {"a", "b"}}}, is_taken<contract::SubmitMerge>), 15);
  EXPECT_GT(check_ranges("RunMerge", json::object(), is_taken<contract::RunMerge>), 4);
}

}  // namespace
}  // namespace mapweld::test
