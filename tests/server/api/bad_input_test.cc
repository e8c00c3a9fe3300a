// What strangers and broken robots send: each gets a clear problem, and nothing stored changes.
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "client/contract/problem.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

class BadInput : public ::testing::Test {
 protected:
  BadInput() {
    api_.services().create_map("a");
    api_.services().create_map("b");
    for (int step = 0; step < 3; ++step) {
      api_.services().upload("a", "step-" + std::to_string(step), photo_jpeg(1, step));
      api_.services().upload("b", "step-" + std::to_string(step), photo_jpeg(1, step + 1));
    }
    stored_ = dump_store(api_.services().store());
  }

  void TearDown() override { EXPECT_EQ(dump_store(api_.services().store()), stored_); }

  std::string submit(const std::string& body) { return api_.post("/v1/merges", body).code(); }
  std::string create(const std::string& body) { return api_.post("/v1/maps", body).code(); }

  ApiUnderTest api_;
  std::string stored_;
};

TEST_F(BadInput, ImagesThatAreNone) {
  const std::string path = "/v1/maps/a/images?name=x";
  const std::string good = photo_jpeg(1, 5);
  struct Case {
    std::string bytes;
    std::string code;
  };
  std::string corrupt_png = png(photo(1, 5));
  corrupt_png[corrupt_png.size() / 2] = static_cast<char>(corrupt_png[corrupt_png.size() / 2] ^ 0xFF);
  for (const Case& bad :
       {Case{"", "empty_body"}, Case{"x", "unsupported_image"}, Case{"{\"name\":1}", "unsupported_image"},
        Case{std::string(100'000, '\0'), "unsupported_image"}, Case{"%PDF-1.4", "unsupported_image"},
        Case{good.substr(0, 20), "undecodable_image"}, Case{good.substr(0, 200), "undecodable_image"},
        Case{good.substr(0, good.size() - 500), "undecodable_image"},
        Case{png(photo(1, 5)).substr(0, 5000), "undecodable_image"}, Case{corrupt_png, "undecodable_image"}}) {
    const Answer upload = api_.post_image(path, bad.bytes);
    EXPECT_EQ(upload.code(), bad.code) << upload.body;
    EXPECT_EQ(api_.post_image("/v1/maps/a/localize", bad.bytes).code(), bad.code);
  }
}

TEST_F(BadInput, ImagesThatAreTooLarge) {
  for (const auto& [width, height] : {std::pair{20'000, 20'000}, std::pair{8193, 1}, std::pair{4001, 4000}}) {
    // One bit a pixel: small as a file, whatever its size as an image.
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", cv::Mat(height, width, CV_8UC1, cv::Scalar(0)), bytes, {cv::IMWRITE_PNG_BILEVEL, 1});
    const Answer answer = api_.post_image("/v1/maps/a/images", {bytes.begin(), bytes.end()});
    EXPECT_EQ(answer.status, 413);
    EXPECT_EQ(answer.code(), "image_too_large") << width << " x " << height;
  }
}

TEST_F(BadInput, NamesThatAreNone) {
  const std::string image = photo_jpeg(1, 5);
  for (const std::string& name :
       {std::string("%00"), std::string("a%0Ab"), std::string("%ff%fe"), std::string(256, 'x'), std::string()}) {
    EXPECT_EQ(api_.post_image("/v1/maps/a/images?name=" + name, image).code(), "invalid_name") << name;
  }
  for (const char* name : {"", ".hidden", "a/b", "ä", "a b", "x\\u0000"}) {
    EXPECT_EQ(create(R"({"name":")" + std::string(name) + "\"}"), "invalid_name") << name;
  }
  EXPECT_EQ(create(R"({"name":")" + std::string(65, 'x') + "\"}"), "invalid_name");
}

TEST_F(BadInput, JsonThatIsNone) {
  for (const char* path : {"/v1/maps", "/v1/merges", "/v1/merges/1/resume", "/v1/merges/1/restart"}) {
    for (const std::string& body : {std::string("{"), std::string("nonsense"), std::string("{\"name\":\"x\"}}"),
                                    std::string("\"x\""), std::string("[]"), std::string("{\"name\":\"\xff\"}"),
                                    std::string(100'000, '['), "{\"name\":" + std::string(50'000, '[') + "}"}) {
      EXPECT_EQ(api_.post(path, body).code(), "malformed_json") << path << " " << body.substr(0, 30);
    }
  }
  std::string deep;
  for (int i = 0; i < 40'000; ++i) deep += "{\"a\":";
  EXPECT_EQ(create(deep), "malformed_json");
  EXPECT_EQ(create(""), "empty_body");
  EXPECT_EQ(create("  \n"), "empty_body");
  EXPECT_EQ(create(std::string(2 << 20, ' ')), "body_too_large");
}

TEST_F(BadInput, FieldsOfWrongTypes) {
  for (const char* body :
       {R"({"name":7})", R"({"name":null})", R"({"name":["x"]})", R"({})", R"({"name":"x","labels":"red"})",
        R"({"name":"x","labels":{"a":1}})", R"({"name":"x","parameters":[]})",
        R"({"name":"x","parameters":{"max_features":"500"}})", R"({"name":"x","parameters":{"max_features":0}})",
        R"({"name":"x","parameters":{"max_features":1e300}})", R"({"name":"x","parameters":{"min_votes":-1}})",
        R"({"name":"x","parameters":{"votes":"all"}})", R"({"name":"x","parameters":{"store_images":true}})",
        R"({"name":"x","uuid":"7"})"}) {
    EXPECT_EQ(create(body), "invalid_parameter") << body;
  }
  for (const char* body : {R"({"name":"x","x":1})", R"({"name":"x","parameters":{"x":1}})"}) {
    EXPECT_EQ(create(body), "unknown_field") << body;
  }
  EXPECT_EQ(create(R"({"name":"x","name":"y"})"), "malformed_json");
}

TEST_F(BadInput, BudgetsThatAreNone) {
  for (const char* budget : {R"({"seconds":0})", R"({"seconds":-1})", R"({"seconds":"1"})", R"({"seconds":true})",
                             R"({"verifications":0})", R"({"verifications":-7})", R"({"verifications":1.5})",
                             R"({"verifications":99999999999999999999})", R"({"edges":0})", R"({"edges":-1})",
                             R"({"fraction_of_maximum":0})", R"({"fraction_of_maximum":1.01})", R"(7)", R"([])"}) {
    EXPECT_EQ(submit(R"({"maps":["a","b"],"name":"x","budget":)" + std::string(budget) + "}"), "invalid_budget")
        << budget;
  }
  EXPECT_EQ(submit(R"({"maps":["a","b"],"name":"x","budget":{"second":1}})"), "unknown_field");
  EXPECT_EQ(submit(R"({"maps":["a","b"],"name":"x","budget":{"seconds":1e999}})"), "malformed_json");
}

TEST_F(BadInput, MergesThatCannotBe) {
  EXPECT_EQ(submit(R"({"maps":["a","a"],"name":"x"})"), "duplicate_member");
  EXPECT_EQ(submit(R"({"maps":[],"name":"x"})"), "too_few_members");
  EXPECT_EQ(submit(R"({"maps":["a"],"name":"x"})"), "too_few_members");
  EXPECT_EQ(submit(R"({"maps":["a","nope"],"name":"x"})"), "no_such_map");
  EXPECT_EQ(submit(R"({"maps":["a","b"],"name":"a"})"), "name_taken");
  EXPECT_EQ(submit(R"({"maps":["a","b"],"name":"x","method":"QuickConnect"})"), "unknown_method");
  EXPECT_EQ(submit(R"({"maps":["a","b"],"name":"x","seed":-1})"), "invalid_parameter");
  EXPECT_EQ(submit(R"({"maps":["a","b"],"name":"x","parameters":{"min_inliers":0}})"), "invalid_parameter");
  EXPECT_EQ(submit(R"({"maps":"ab","name":"x"})"), "invalid_parameter");
  EXPECT_EQ(submit(R"({"name":"x"})"), "invalid_parameter");
}

TEST_F(BadInput, QueriesThatAreNone) {
  const std::string image = photo_jpeg(1, 5);
  EXPECT_EQ(api_.get("/v1/maps?limit=0").code(), "invalid_parameter");
  EXPECT_EQ(api_.get("/v1/maps?cursor=%00").code(), "invalid_parameter");
  EXPECT_EQ(api_.get("/v1/maps?page=2").code(), "unknown_field");
  EXPECT_EQ(api_.get("/v1/maps/a/edges?kind=outer").code(), "invalid_parameter");
  EXPECT_EQ(api_.get("/v1/maps/a/edges?min_inliers=-1").code(), "invalid_parameter");
  EXPECT_EQ(api_.get("/v1/maps/a/graph?format=svg").code(), "invalid_parameter");
  EXPECT_EQ(api_.get("/v1/maps/a/route?from=0").code(), "invalid_parameter");
  EXPECT_EQ(api_.get("/v1/maps/a/vertices/-1").code(), "no_such_vertex");
  EXPECT_EQ(api_.get("/v1/maps/a/vertices/4294967296").code(), "no_such_vertex");
  EXPECT_EQ(api_.get("/v1/merges/x").code(), "no_such_merge");
  EXPECT_EQ(api_.get("/v1/merges?state=asleep").code(), "invalid_parameter");
  EXPECT_EQ(api_.post_image("/v1/maps/a/localize?limit=0", image).code(), "invalid_parameter");
  EXPECT_EQ(api_.post_image("/v1/maps/a/localize?verified=maybe", image).code(), "invalid_parameter");
  EXPECT_EQ(api_.post_image("/v1/maps/a/images?captured_at=yesterday", image).code(), "invalid_parameter");
  EXPECT_EQ(api_.post_image("/v1/maps/a/images?index=-1", image).code(), "invalid_parameter");
  EXPECT_EQ(api_.post_image("/v1/maps/a/images?sequence=%07", image).code(), "invalid_parameter");
}

}  // namespace
}  // namespace mapweld::test
