// Every code of the contract's table is provoked over HTTP, or said here why it is not; and nothing stored changes by
// it.
#include <functional>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "client/contract/problem.h"
#include "core/vocabulary/vocabulary.h"
#include "tests/server/http/raw_client.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

std::string file_of(const Vocabulary& vocabulary) {
  const auto bytes = vocabulary.serialize();
  return {bytes.begin(), bytes.end()};
}

// PNG with this size in its header, and nothing that could be decoded.
std::string png_of_size(std::uint32_t width, std::uint32_t height) {
  std::string bytes("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  for (const std::uint32_t value : {width, height}) {
    for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<char>(value >> shift & 0xFF));
  }
  return bytes + std::string("\x08\x02\0\0\0", 5) + std::string(100, '\0');
}

// Maps "a" and "b" of three vertices each and a blank one, merged as "ab" (merge 1, completed); "c", empty, with
// another vocabulary.
class CodeTable : public ::testing::Test {
 protected:
  CodeTable() : api_(options()) {
    for (const char* map : {"a", "b"}) {
      api_.services().create_map(map);
      for (int step = 0; step < 3; ++step) {
        api_.services().upload(map, "step-" + std::to_string(step), photo_jpeg(1, step));
      }
      api_.services().upload(map, "blank", jpeg(blank()));
    }
    api_.post("/v1/vocabularies?name=other", file_of(small_vocabulary()), "application/octet-stream");
    api_.post("/v1/maps", R"({"name":"c","vocabulary":"other"})");
    api_.post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})");
    EXPECT_EQ(api_.finished_merge(1)["state"], "completed");
  }

  static server::HttpOptions options() {
    server::HttpOptions options;
    options.max_body_bytes = 4 << 20;
    options.connection.head_timeout_ms = 300;
    return options;
  }

  std::string raw(std::string_view bytes) const {
    RawClient client(api_.port());
    client.send(bytes);
    const std::string reply = client.receive();
    const std::size_t body = reply.find("\r\n\r\n");
    return body == std::string::npos ? "" : contract::parse_json(reply.substr(body + 4)).value("code", "");
  }

  ApiUnderTest api_;
};

TEST_F(CodeTable, IsReachedWholeAndNothingStoredChanges) {
  const std::string image = photo_jpeg(1, 0);
  const std::string images = "/v1/maps/a/images";
  std::map<std::string, std::function<std::string()>> provoke = {
      {"malformed_json", [&] { return api_.post("/v1/maps", "{").code(); }},
      {"malformed_multipart",
       [&] { return api_.post(images + "/batch", "x", "multipart/form-data; boundary=b").code(); }},
      {"malformed_request", [&] { return raw("GET /healthz HTTP/9\r\n\r\n"); }},
      {"unknown_field", [&] { return api_.post("/v1/maps", R"({"name":"x","colour":"red"})").code(); }},
      {"empty_body", [&] { return api_.post_image(images + "?name=x", "").code(); }},
      {"invalid_name", [&] { return api_.post("/v1/maps", R"({"name":"no slug"})").code(); }},
      {"no_such_path", [&] { return api_.get("/v1/nothing").code(); }},
      {"no_such_map", [&] { return api_.get("/v1/maps/x").code(); }},
      {"no_such_vertex", [&] { return api_.get("/v1/maps/a/vertices/99").code(); }},
      {"no_such_image",
       [&] {
         api_.post("/v1/maps", R"({"name":"bare","parameters":{"store_images":"none"}})");
         api_.post_image("/v1/maps/bare/images", image);
         const std::string code = api_.get("/v1/maps/bare/vertices/0/image").code();
         api_.del("/v1/maps/bare");
         return code;
       }},
      {"no_such_mask", [&] { return api_.get("/v1/maps/a/mask").code(); }},
      {"no_such_vocabulary", [&] { return api_.get("/v1/vocabularies/x").code(); }},
      {"no_such_merge", [&] { return api_.get("/v1/merges/77").code(); }},
      {"no_such_backup", [&] { return api_.get("/v1/backups/7").code(); }},
      {"vocabulary_in_use", [&] { return api_.del("/v1/vocabularies/words").code(); }},
      {"immutable_parameter",
       [&] { return api_.ask("PATCH", "/v1/maps/a", {}, R"({"parameters":{"max_features":100}})").code(); }},
      {"damaged_file", [&] { return api_.post("/v1/maps:import?name=x", "no map").code(); }},
      {"no_route", [&] { return api_.get("/v1/maps/a/route?from=0&to=3").code(); }},
      {"method_not_allowed", [&] { return api_.del("/v1/maps").code(); }},
      {"request_timeout", [&] { return raw("GET /healthz"); }},
      {"name_taken", [&] { return api_.post_image(images + "?name=step-0", photo_jpeg(1, 1)).code(); }},
      {"wrong_map",
       [&] { return api_.post_image(images + "?map_uuid=00000000-0000-4000-8000-000000000000", image).code(); }},
      {"map_in_use", [&] { return api_.del("/v1/maps/a").code(); }},
      {"map_is_merged", [&] { return api_.post_image("/v1/maps/ab/images", image).code(); }},
      {"vocabulary_mismatch", [&] { return api_.post("/v1/merges", R"({"maps":["a","c"],"name":"x"})").code(); }},
      {"wrong_state", [&] { return api_.post("/v1/merges/1/pause", "").code(); }},
      {"nothing_to_resume", [&] { return api_.post("/v1/merges/1/resume", "").code(); }},
      {"length_required", [&] { return raw("POST /v1/maps HTTP/1.1\r\nHost: localhost\r\n\r\n"); }},
      {"body_too_large", [&] { return api_.post_image(images, std::string((4 << 20) + 1, 'x')).code(); }},
      {"image_too_large", [&] { return api_.post_image(images, png_of_size(20'000, 20'000)).code(); }},
      {"too_many_images",
       [&] {
         return api_.post_batch(images + "/batch", std::vector<std::pair<std::string, std::string>>(65, {"x", "x"}))
             .code();
       }},
      {"uri_too_long", [&] { return api_.get("/" + std::string(9000, 'x')).code(); }},
      {"unsupported_image", [&] { return api_.post_image(images, "GIF89a").code(); }},
      {"unsupported_media_type", [&] { return api_.post_image(images + "/batch", image).code(); }},
      {"unknown_host", [&] { return raw("GET /v1/maps HTTP/1.1\r\nHost: rebound.example\r\n\r\n"); }},
      {"undecodable_image", [&] { return api_.post_image(images, image.substr(0, image.size() / 2)).code(); }},
      {"empty_mask",
       [&] { return api_.put("/v1/maps/a/mask", png(cv::Mat::zeros(4, 4, CV_8UC1)), "image/png").code(); }},
      {"duplicate_member", [&] { return api_.post("/v1/merges", R"({"maps":["a","a"],"name":"x"})").code(); }},
      {"too_few_members", [&] { return api_.post("/v1/merges", R"({"maps":["a"],"name":"x"})").code(); }},
      {"unknown_method",
       [&] { return api_.post("/v1/merges", R"({"maps":["a","b"],"name":"x","method":"magic"})").code(); }},
      {"invalid_budget",
       [&] { return api_.post("/v1/merges", R"({"maps":["a","b"],"name":"x","budget":{"seconds":-1}})").code(); }},
      {"invalid_parameter", [&] { return api_.get("/v1/maps?limit=1001").code(); }},
      {"invalid_vocabulary", [&] { return api_.post("/v1/vocabularies?name=x", "hello").code(); }},
      {"headers_too_large", [&] { return raw(std::string(40'000, 'x')); }},
      {"not_ready",
       [&] {
         api_.ready = false;
         const std::string code = api_.get("/readyz").code();
         api_.ready = true;
         return code;
       }},
      {"no_space",
       [&] {
         api_.services().store().limit_pages(1);
         const std::string code = api_.post("/v1/vocabularies?name=x", file_of(small_vocabulary())).code();
         api_.services().store().limit_pages(1 << 20);
         return code;
       }},
  };
  const std::map<std::string, std::string> elsewhere = {
      {"busy", "HttpLimits.TurnsRequestsAwayWhenTooManyWait, AllBodiesTogetherHaveALimit"},
      {"shutting_down", "ImageService.AServerThatStopsRefusesWhatIsNotYetStored"},
      {"internal_error", "HttpServerTest.AnExceptionTellsTheClientNothingOfTheInside"},
      {"range_not_satisfiable", "HttpFilesTest.WhatIsNoRangeIsIgnoredAndOneBeyondTheEndRefused"},
      {"unauthorized", "AccessApi.EachRoleOpensItsRoutesAndNoOther"},
      {"forbidden", "AccessApi.EachRoleOpensItsRoutesAndNoOther"},
      {"read_only", "ReadOnlyServer.RefusesWhateverChangesSomething"},
      {"rate_limited", "AccessGateTest.AKeyHasItsRate"},
      {"idempotency_in_progress", "LostAnswers.AKeyIsFreeAgainWhenItsRequestHasEnded"},
      {"idempotency_mismatch", "Idempotency.AnotherRequestUnderTheKeyIsRefused"},
      {"quota_exceeded", "Quotas.ImagesBeyondAreRefusedAndDeletingGivesBack"},
      {"not_implemented", "reserved: whatever is settled is served"},
  };
  const std::string stored = dump_store(api_.services().store());
  for (const contract::CodeEntry& entry : contract::kCodes) {
    const std::string code(entry.code);
    if (elsewhere.contains(code)) continue;
    ASSERT_TRUE(provoke.contains(code)) << code;
    EXPECT_EQ(provoke[code](), code);
    if (code == "no_such_image") continue;  // made and deleted a map of its own
    EXPECT_EQ(dump_store(api_.services().store()), stored) << code;
  }
}

TEST_F(CodeTable, AProblemHasAllItsFields) {
  const Answer answer = api_.get("/v1/maps/x");
  EXPECT_EQ(answer.status, 404);
  const contract::Json problem = answer.json();
  EXPECT_EQ(problem["type"], "urn:mapweld:problem:no_such_map");
  EXPECT_EQ(problem["title"], "There is no map of this name");
  EXPECT_EQ(problem["status"], 404);
  EXPECT_EQ(problem["detail"], "There is no map named \"x\".");
  EXPECT_EQ(problem["code"], "no_such_map");
  EXPECT_EQ(problem["request_id"], answer.header("X-Request-Id"));
}

}  // namespace
}  // namespace mapweld::test
