// Requests are read strictly: what is wrong with one is found, named and given its code.
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "client/contract/json.h"
#include "client/contract/map.h"
#include "client/contract/merge.h"
#include "client/contract/names.h"
#include "client/contract/problem_document.h"

namespace mapweld::contract {
namespace {

// The code and detail that `action` fails with; "" when it does not.
std::string failure(const std::function<void()>& action) {
  try {
    action();
  } catch (const ContractError& error) {
    return std::string(error.code().word()) + ": " + error.detail();
  }
  return "";
}
std::string parsing(const std::string& text) {
  return failure([&] { parse_json(text); });
}
template <class T>
std::string reading(const std::string& text) {
  return failure([&] { check(read_request<T>(parse_json(text))); });
}

// That `failed` has this code and that its detail speaks of `word`.
testing::AssertionResult fails(const std::string& failed, const std::string& code, const std::string& word) {
  if (failed.rfind(code + ": ", 0) == 0 && failed.find(word) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "expected " << code << " about " << word << ", got: " << failed;
}

TEST(ParseJson, RefusesWhatIsNotOneDocument) {
  EXPECT_TRUE(fails(parsing(""), "empty_body", "empty"));
  EXPECT_TRUE(fails(parsing(" \n"), "empty_body", "empty"));
  for (const char* text : {"{", "{\"a\":}", "[1,]", "nul", "{} {}", "\"\xff\"", "'a'", "\"a", "NaN", "-"}) {
    EXPECT_TRUE(fails(parsing(text), "malformed_json", "byte")) << text;
  }
  EXPECT_TRUE(fails(parsing("[1e999]"), "malformed_json", "out of range"));
  EXPECT_TRUE(fails(parsing(R"({"a":{"b":1},"b":1,"b":2})"), "malformed_json", "\"b\" appears twice"));
  EXPECT_EQ(parsing(R"({"a":{"a":1},"b":[{"a":1},{"a":2}]})"), "");
}

TEST(ParseJson, AnObjectHasABoundedNumberOfFields) {
  const auto object = [](std::size_t fields) {
    std::string text = "{";
    for (std::size_t i = 0; i < fields; ++i) text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
    return text + "}";
  };
  EXPECT_EQ(parsing(object(kMaxJsonFields)), "");
  EXPECT_EQ(parsing("[" + object(kMaxJsonFields) + "," + object(kMaxJsonFields) + "]"), "");
  EXPECT_TRUE(fails(parsing(object(kMaxJsonFields + 1)), "malformed_json", "256 fields"));
  EXPECT_TRUE(fails(parsing("{\"a\":" + object(100'000) + "}"), "malformed_json", "256 fields"));
}

TEST(ParseJson, StopsAtTheDepthLimitWithoutBuilding) {
  const auto nested = [](std::size_t depth, const std::string& open, const std::string& close) {
    std::string text;
    for (std::size_t i = 0; i < depth; ++i) text += open;
    text += "1";
    for (std::size_t i = 0; i < depth; ++i) text += close;
    return text;
  };
  EXPECT_EQ(parsing(nested(kMaxJsonDepth, "[", "]")), "");
  EXPECT_EQ(parsing(nested(kMaxJsonDepth, "{\"a\":", "}")), "");
  EXPECT_TRUE(fails(parsing(nested(kMaxJsonDepth + 1, "[", "]")), "malformed_json", "32 levels"));
  EXPECT_TRUE(fails(parsing(nested(kMaxJsonDepth + 1, "{\"a\":", "}")), "malformed_json", "32 levels"));
  EXPECT_TRUE(fails(parsing(nested(100000, "[", "]")), "malformed_json", "32 levels"));
  EXPECT_TRUE(fails(parsing(nested(100000, "{\"a\":[", "]}")), "malformed_json", "32 levels"));
  EXPECT_TRUE(fails(parsing(std::string(10000000, '[')), "malformed_json", "32 levels"));
}

TEST(Dump, ReplacesBytesThatAreNotUtf8) { EXPECT_EQ(dump(Json("a\xff")), "\"a\xEF\xBF\xBD\""); }

TEST(CreateMapRequest, TakesWhatIsRight) {
  EXPECT_EQ(reading<CreateMap>(R"({"name":"lab-a"})"), "");
  EXPECT_EQ(reading<CreateMap>(R"({"name":"lab-a","vocabulary":null,"parameters":{"min_votes":12.0,"votes":"min"},
                                   "labels":{"robot":"p3at"},"uuid":"7d444840-9dc0-11d1-b245-5ffdce74fad2"})"),
            "");
}

TEST(CreateMapRequest, NamesTheFieldThatIsWrong) {
  EXPECT_TRUE(fails(reading<CreateMap>("[]"), "malformed_json", "object"));
  EXPECT_TRUE(fails(reading<CreateMap>("{}"), "invalid_parameter", "\"name\" is missing"));
  EXPECT_TRUE(
      fails(reading<CreateMap>(R"({"name":5})"), "invalid_parameter", "\"name\" must be a string, not the number 5"));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":null})"), "invalid_parameter", "not null"));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":"a","colour":1})"), "unknown_field", "\"colour\""));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":"a","parameters":{"min_vote":1}})"), "unknown_field",
                    "\"parameters.min_vote\""));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":"a","parameters":{"min_votes":1.5}})"), "invalid_parameter",
                    "\"parameters.min_votes\" must be a whole number"));
  EXPECT_TRUE(
      fails(reading<CreateMap>(R"({"name":"a","parameters":{"min_votes":-3}})"), "invalid_parameter", "1 to 65535"));
  EXPECT_TRUE(
      fails(reading<CreateMap>(R"({"name":"a","parameters":{"min_votes":1e12}})"), "invalid_parameter", "range"));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":"a","parameters":{"min_votes":18446744073709551615}})"),
                    "invalid_parameter", "range"));
  EXPECT_TRUE(
      fails(reading<CreateMap>(R"({"name":"a","parameters":{"votes":"sum"}})"), "invalid_parameter", "\"product\""));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":"a","parameters":{"min_inliers":20,"max_inliers":19}})"),
                    "invalid_parameter", "exceed"));
  EXPECT_TRUE(
      fails(reading<CreateMap>(R"({"name":"a","labels":{"robot":7}})"), "invalid_parameter", "\"labels.robot\""));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":"a","uuid":"7d44"})"), "invalid_parameter", "\"uuid\""));
  EXPECT_TRUE(fails(reading<CreateMap>(R"({"name":"a/b"})"), "invalid_name", "map's name"));
}

TEST(SubmitMergeRequest, NamesWhatIsWrong) {
  EXPECT_EQ(reading<SubmitMerge>(R"({"maps":["a","b"]})"), "");
  EXPECT_EQ(reading<SubmitMerge>(R"({"maps":["a","b","c"],"budget":null,"method":"brute-force"})"), "");
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({})"), "invalid_parameter", "\"maps\" is missing"));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":"a"})"), "invalid_parameter", "must be an array, not a string"));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a",1]})"), "invalid_parameter", "\"maps[1]\""));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a"]})"), "too_few_members", "two"));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a","b","a"]})"), "duplicate_member", "\"a\""));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a","b"],"method":"fast"})"), "unknown_method", "fast"));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a","b"],"seed":-1})"), "invalid_parameter", "seed"));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a","b"],"seed":"1"})"), "invalid_parameter", "seed"));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a","b/c"]})"), "invalid_name", "map's name"));
  EXPECT_TRUE(fails(reading<SubmitMerge>(R"({"maps":["a","b"],"name":""})"), "invalid_name", "merged map"));
}

TEST(BudgetRequest, IsPositiveAndFinite) {
  const auto budget = [](const std::string& text) {
    return reading<SubmitMerge>(R"({"maps":["a","b"],"budget":)" + text + "}");
  };
  for (const char* text : {"null", "{}", R"({"seconds":1.5})", R"({"seconds":1e300})", R"({"verifications":1})",
                           R"({"edges":100.0})", R"({"fraction_of_maximum":1})", R"({"seconds":null,"certified":true})",
                           R"({"fraction_of_maximum":0.9,"certified":true})"}) {
    EXPECT_EQ(budget(text), "") << text;
  }
  for (const char* text :
       {R"({"seconds":0})", R"({"seconds":-1})", R"({"seconds":"1"})", R"({"verifications":0})", R"({"edges":-5})",
        R"({"verifications":1.5})", R"({"verifications":1e30})", R"({"fraction_of_maximum":0})",
        R"({"fraction_of_maximum":1.01})", R"({"certified":"yes"})", "5", "[]", "\"1.5s\""}) {
    EXPECT_TRUE(fails(budget(text), "invalid_budget", "budget")) << text;
  }
  EXPECT_TRUE(fails(budget(R"({"hours":1})"), "unknown_field", "\"budget.hours\""));
  EXPECT_TRUE(fails(reading<RunMerge>(R"({"budget":{"seconds":-1}})"), "invalid_budget", "seconds"));
  EXPECT_TRUE(fails(reading<RunMerge>(R"({"seconds":1})"), "unknown_field", "\"seconds\""));
}

TEST(Names, SlugsAndImageNames) {
  for (const char* name : {"a", "0", "lab-a", "Lab_1.2"}) EXPECT_TRUE(is_slug(name)) << name;
  EXPECT_TRUE(is_slug(std::string(64, 'a')));
  EXPECT_FALSE(is_slug(std::string(65, 'a')));
  for (const char* name : {"", "-a", ".a", "_a", "a b", "a/b", "\xC3\xA4", "a\n"}) EXPECT_FALSE(is_slug(name)) << name;

  for (const char* name : {"a", "000812.jpg", "run 1/a.png", "\xC3\xA4.jpg", "\xE2\x82\xAC", "\xF0\x9F\x97\xBA.png"}) {
    EXPECT_TRUE(is_image_name(name)) << name;
  }
  EXPECT_TRUE(is_image_name(std::string(255, 'a')));
  EXPECT_FALSE(is_image_name(std::string(256, 'a')));
  EXPECT_FALSE(is_image_name(std::string_view("a\0b", 3)));
  for (const char* name : {"", "a\n", "\x7F", "\xC2\x80", "\xC2\x9F", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80",
                           "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xE2\x82", "\x80", "\xFF"}) {
    EXPECT_FALSE(is_image_name(name)) << name;
  }
}

TEST(DefaultMergeName, IsASlug) {
  EXPECT_EQ(default_merge_name({"lab-a", "lab-b"}), "lab-a_lab-b");
  EXPECT_TRUE(is_slug(default_merge_name({std::string(64, 'a'), std::string(64, 'b')})));
}

TEST(Codes, ComeFromOneTable) {
  for (std::size_t i = 0; i < kCodes.size(); ++i) {
    EXPECT_GE(kCodes[i].status, 400);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(kCodes[i].code, kCodes[j].code);
  }
  EXPECT_EQ(Code::find("undecodable_image").status(), 422);
  EXPECT_EQ(Code::find("no such word").word(), "internal_error");
  const Problem problem = problem_of("map_in_use", "Merge 1 uses it.", "r1");
  EXPECT_EQ(problem.status, 409);
  EXPECT_EQ(problem.code, "map_in_use");
  EXPECT_EQ(problem.type, "urn:mapweld:problem:map_in_use");
}

}  // namespace
}  // namespace mapweld::contract
