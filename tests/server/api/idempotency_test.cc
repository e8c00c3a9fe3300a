// Requests with an Idempotency-Key take effect once: the first answer again, whatever came between.
#include "server/api/idempotency.h"

#include <atomic>
#include <fstream>
#include <future>
#include <latch>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/access/access_gate.h"
#include "tests/server/access/keys_under_test.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"
#include "tests/server/support/uploads.h"

namespace mapweld::test {
namespace {

using contract::Json;
using server::IdempotencyKeys;
using server::Once;
using server::Reply;
using server::Request;
using ::testing::HasSubstr;

httplib::Headers keyed(const std::string& key) { return {{"Idempotency-Key", key}}; }

bool is_replayed(const Answer& answer) { return answer.header("Idempotent-Replayed") == "true"; }

class Idempotency : public ::testing::Test {
 protected:
  Answer make(const std::string& name, const std::string& key) const {
    return api_.ask("POST", "/v1/maps", keyed(key), R"({"name":")" + name + "\"}");
  }
  // A batch of images without names: nothing but its key tells that it was sent before.
  Answer batch(const std::string& map, const std::vector<std::string>& images, const std::string& key,
               const std::string& boundary = "boundary") const {
    std::string body;
    for (const std::string& image : images) {
      body += "--" + boundary + "\r\nContent-Disposition: form-data; name=\"i\"\r\n\r\n" + image + "\r\n";
    }
    httplib::Headers headers = keyed(key);
    headers.emplace("Content-Type", "multipart/form-data; boundary=" + boundary);
    return api_.ask("POST", "/v1/maps/" + map + "/images/batch", headers, body + "--" + boundary + "--\r\n");
  }
  std::string state() { return dump_store(api_.services().store()); }
  std::int64_t images(const std::string& map) const {
    const Json shown = api_.get("/v1/maps/" + map).json();
    return shown["vertices"].get<std::int64_t>() + shown["ignored"].get<std::int64_t>();
  }

  void expect_same(const Answer& first, const Answer& again, const std::string& what = "") const {
    EXPECT_FALSE(is_replayed(first)) << what;
    EXPECT_TRUE(is_replayed(again)) << what;
    EXPECT_EQ(again.status, first.status) << what;
    EXPECT_EQ(again.body, first.body) << what;
    for (const char* name : {"Location", "Content-Type", "Retry-After"}) {
      EXPECT_EQ(again.header(name), first.header(name)) << what << " " << name;
    }
  }

  ApiUnderTest api_;
};

TEST_F(Idempotency, TheFirstAnswerIsGivenAgain) {
  const Answer first = make("lab", "k");
  EXPECT_EQ(first.status, 201) << first.body;
  EXPECT_EQ(first.header("Location"), "/v1/maps/lab");
  const std::string before = state();
  expect_same(first, make("lab", "k"));
  EXPECT_EQ(state(), before);
  EXPECT_EQ(make("lab", "another").code(), "name_taken");
  EXPECT_EQ(api_.del("/v1/maps/lab").status, 204);
  expect_same(first, make("lab", "k"));
  EXPECT_EQ(api_.get("/v1/maps/lab").status, 404);
}

TEST_F(Idempotency, AnotherRequestUnderTheKeyIsRefused) {
  make("lab", "k");
  const std::string before = state();
  EXPECT_EQ(make("other", "k").code(), "idempotency_mismatch");
  EXPECT_EQ(make("other", "k").status, 422);
  const std::string image = photo_jpeg(1, 0);
  const std::string path = "/v1/maps/lab/images";
  EXPECT_EQ(api_.ask("POST", path, keyed("k"), image).code(), "idempotency_mismatch");
  EXPECT_EQ(state(), before);
  EXPECT_EQ(api_.ask("POST", path + "?name=a", keyed("i"), image).status, 201);
  EXPECT_EQ(api_.ask("POST", path + "?name=b", keyed("i"), image).code(), "idempotency_mismatch");
  EXPECT_EQ(api_.ask("POST", path + "?name=a", keyed("i"), image + " ").code(), "idempotency_mismatch");
  EXPECT_EQ(batch("lab", {image}, "b").status, 200);
  EXPECT_EQ(batch("lab", {image, image}, "b").code(), "idempotency_mismatch");
}

TEST_F(Idempotency, AKeyIs1To255VisibleCharacters) {
  for (const std::string& key : {std::string(), std::string(256, 'k'), std::string("a b"), std::string("k\xC3\xA4")}) {
    const Answer answer = make("lab", key);
    EXPECT_EQ(answer.code(), "invalid_parameter") << key;
    EXPECT_EQ(answer.status, 422) << key;
  }
  const Answer twice =
      api_.ask("POST", "/v1/maps", {{"Idempotency-Key", "a"}, {"Idempotency-Key", "a"}}, R"({"name":"lab"})");
  EXPECT_EQ(twice.code(), "invalid_parameter");
  EXPECT_EQ(make("lab", std::string(255, '~')).status, 201);
}

TEST_F(Idempotency, AnAnswerIsKeptFor24Hours) {
  const Answer first = make("lab", "k");
  api_.later_s = 24 * 3600 - 60;
  expect_same(first, make("lab", "k"));
  api_.later_s = 24 * 3600 + 60;
  EXPECT_EQ(make("lab", "k").code(), "name_taken");
  EXPECT_EQ(make("other", "k").status, 201);
  EXPECT_TRUE(is_replayed(make("other", "k")));
}

TEST_F(Idempotency, ExpiredAnswersAreDropped) {
  const auto kept = [&] {
    return api_.services().store().read().connection().query_integer("SELECT count(*) FROM kept_answers");
  };
  for (int i = 0; i < 20; ++i) make("m" + std::to_string(i), std::to_string(i));
  EXPECT_EQ(kept(), 20);
  api_.later_s = 25 * 3600;
  make("one", "one");
  EXPECT_EQ(kept(), 5);
  make("two", "two");
  EXPECT_EQ(kept(), 2);
}

TEST_F(Idempotency, WhatHadNoEffectIsTriedAgain) {
  make("lab", "k");
  EXPECT_EQ(make("lab", "l").code(), "name_taken");
  api_.del("/v1/maps/lab");
  EXPECT_EQ(make("lab", "l").status, 201);
}

TEST_F(Idempotency, AnImageWithoutANameIsStoredOnce) {
  api_.services().create_map("lab");
  for (const std::string& image : {photo_jpeg(1, 0), photo_jpeg(1, 0), photo_jpeg(1, 1)}) {
    const std::string key = std::to_string(images("lab"));
    const Answer first = api_.ask("POST", "/v1/maps/lab/images", keyed(key), image);
    const std::int64_t there = images("lab");
    expect_same(first, api_.ask("POST", "/v1/maps/lab/images", keyed(key), image));
    EXPECT_EQ(images("lab"), there);
  }
  EXPECT_EQ(images("lab"), 3);
}

TEST_F(Idempotency, ABatchIsKeptImageByImage) {
  api_.services().create_map("lab");
  const std::vector<std::string> parts = {photo_jpeg(1, 0), "no image", photo_jpeg(1, 1), photo_jpeg(1, 1)};
  const Answer first = batch("lab", parts, "k");
  ASSERT_EQ(first.status, 200) << first.body;
  EXPECT_EQ(images("lab"), 3);
  const Answer again = batch("lab", parts, "k", "another-boundary");
  Json before = first.json(), after = again.json();
  for (Json* items : {&before, &after}) (*items)["items"][1].erase("request_id");
  EXPECT_EQ(after, before);
  EXPECT_TRUE(is_replayed(again)) << "one part was tried again, and nothing stored";
  EXPECT_EQ(images("lab"), 3);

  const std::vector<std::string> good = {photo_jpeg(2, 0), photo_jpeg(2, 1)};
  const Answer whole = batch("lab", good, "g");
  expect_same(whole, batch("lab", good, "g", "another"));
  EXPECT_EQ(images("lab"), 5);
}

TEST_F(Idempotency, ABatchThatBrokeOffGoesOnWhereItDid) {
  api_.services().create_map("lab");
  std::vector<std::string> parts;
  for (int i = 0; i < 30; ++i) parts.push_back(photo_jpeg(static_cast<std::uint64_t>(10 + i), i % 3));
  Store& store = api_.services().store();
  const auto pages = static_cast<std::uint32_t>(store.read().connection().query_integer("PRAGMA page_count"));
  store.limit_pages(pages + 220);
  const Answer first = batch("lab", parts, "k");
  store.limit_pages(1 << 20);
  const std::int64_t stored = images("lab");
  ASSERT_GT(stored, 0) << first.body;
  ASSERT_LT(stored, 30) << first.body;
  const Answer second = batch("lab", parts, "k");
  EXPECT_FALSE(is_replayed(second));
  const Json before = first.json(), after = second.json();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    ASSERT_TRUE(after["items"][i].contains("outcome")) << after["items"][i];
    EXPECT_EQ(after["items"][i]["vertex"], i);
    if (before["items"][i].contains("outcome")) {
      EXPECT_EQ(before["items"][i], after["items"][i]);
    } else {
      EXPECT_EQ(before["items"][i]["code"], "no_space");
    }
  }
  EXPECT_EQ(images("lab"), 30);
  expect_same(second, batch("lab", parts, "k"));
}

TEST_F(Idempotency, OfManyAtOnceOneTakesEffect) {
  api_.services().create_map("lab");
  constexpr int kAtOnce = 4;
  for (int round = 0; round < 8; ++round) {
    const std::string image = photo_jpeg(static_cast<std::uint64_t>(round), 0);
    std::latch start(kAtOnce);
    std::vector<std::future<Answer>> asked;
    for (int i = 0; i < kAtOnce; ++i) {
      asked.push_back(std::async(std::launch::async, [&] {
        start.arrive_and_wait();
        return api_.ask("POST", "/v1/maps/lab/images", keyed(std::to_string(round)), image);
      }));
    }
    std::set<std::string> bodies;
    int first = 0;
    for (auto& future : asked) {
      const Answer answer = future.get();
      if (answer.code() == "idempotency_in_progress") {
        EXPECT_EQ(answer.status, 409);
        EXPECT_EQ(answer.header("Retry-After"), "1");
        continue;
      }
      EXPECT_EQ(answer.status, 201) << answer.body;
      first += is_replayed(answer) ? 0 : 1;
      bodies.insert(answer.body);
    }
    EXPECT_EQ(first, 1);
    EXPECT_EQ(bodies.size(), 1u);
    EXPECT_EQ(images("lab"), round + 1);
  }
}

TEST(IdempotencyByCaller, EachCallersKeysAreItsOwn) {
  KeysUnderTest keys;
  server::KeyRing ring(keys.folder());
  server::AccessGate gate(ring, {}, server::LogFormat::kText);
  ApiUnderTest api({}, {}, &gate);
  const auto make = [&](const std::string& name, std::optional<std::string> caller) {
    httplib::Headers headers = keyed("k");
    if (caller) headers.merge(bearer(*caller));
    return api.ask("POST", "/v1/maps", headers, R"({"name":")" + name + "\"}");
  };
  EXPECT_EQ(make("anybody", {}).status, 201);
  EXPECT_EQ(make("somebody-else", {}).code(), "idempotency_mismatch") << "nobody is asked who they are";
  const std::string one = keys.make("one", "admin");
  const std::string two = keys.make("two", "admin");
  EXPECT_EQ(make("of-one", one).status, 201);
  EXPECT_EQ(make("of-two", two).status, 201);
  EXPECT_TRUE(is_replayed(make("of-one", one)));
  EXPECT_EQ(make("of-two", one).code(), "idempotency_mismatch");
  keys.revoke("one");
  const std::string again = keys.make("one", "admin");
  EXPECT_EQ(make("of-one", again).code(), "name_taken") << "another key, if of the same name";
}

// Every POST that changes something, in an order in which each is possible; what the answer says is given again after
// the next ones have changed it.
TEST_F(Idempotency, EveryPostKnowsIt) {
  for (const char* map : {"a", "b"}) {
    api_.services().create_map(map);
    for (int step = 0; step < 4; ++step) {
      api_.services().upload(map, "step-" + std::to_string(step), photo_jpeg(1, step));
    }
  }
  api_.del("/v1/maps/b/vertices/3");
  const auto words = small_vocabulary().serialize();
  const std::string file = api_.get("/v1/maps/a/export").body;
  struct Call {
    std::string pattern;
    std::string path;
    std::string body;
  };
  const std::vector<Call> calls = {
      {"/v1/maps", "/v1/maps", R"({"name":"c"})"},
      {"/v1/maps/{map}/images", "/v1/maps/c/images", photo_jpeg(1, 0)},
      {"/v1/vocabularies", "/v1/vocabularies?name=more", {words.begin(), words.end()}},
      {"/v1/maps/{map}/vertices/{vertex}/restore", "/v1/maps/b/vertices/3/restore", ""},
      {"/v1/maps:import", "/v1/maps:import?name=d", file},
      {"/v1/merges", "/v1/merges", R"({"maps":["a","b"],"name":"ab","budget":{"verifications":1}})"},
      {"/v1/merges/{merge}/resume", "/v1/merges/1/resume", R"({"budget":{"verifications":1}})"},
      {"/v1/merges/{merge}/restart", "/v1/merges/1/restart", R"({"budget":{"verifications":1}})"},
      {"/v1/merges/{merge}/cancel", "/v1/merges/1/cancel", ""},
      {"/v1/backups", "/v1/backups", ""},
  };
  std::set<std::string> known = {"/v1/maps/{map}/localize", "/v1/maps/{map}/images/batch",
                                 "/v1/merges/{merge}/pause"};  // changes nothing; above; below
  std::map<std::string, Answer> first;
  for (const Call& call : calls) {
    known.insert(call.pattern);
    first[call.path] = api_.ask("POST", call.path, keyed(call.path), call.body);
    EXPECT_LT(first[call.path].status, 300) << call.path << " " << first[call.path].body;
    if (call.path.starts_with("/v1/merges")) api_.finished_merge(1);
  }
  const std::string before = state();
  for (const Call& call : calls) {
    expect_same(first[call.path], api_.ask("POST", call.path, keyed(call.path), call.body), call.path);
  }
  EXPECT_EQ(state(), before);
  EXPECT_EQ(first["/v1/merges/1/resume"].json()["state"], "queued");
  for (const server::Route& route : api_.routes()) {
    EXPECT_TRUE(route.method != "POST" || known.contains(route.pattern)) << route.pattern;
  }
}

TEST_F(Idempotency, AMergeIsPausedOnce) {
  for (const char* map : {"a", "b"}) {
    api_.services().create_map(map);
    for (int i = 0; i < 12; ++i) api_.services().upload(map, std::to_string(i), photo_jpeg(1, i));
  }
  int paused = 0;
  for (int round = 0; round < 20 && paused < 3; ++round) {
    const std::string name = "m" + std::to_string(round);
    const Answer merge = api_.post("/v1/merges", R"({"maps":["a","b"],"method":"brute-force","name":")" + name + "\"}");
    const std::string path = merge.header("Location") + "/pause";
    const Answer first = api_.ask("POST", path, keyed(name));
    if (first.status == 202) {
      ++paused;
      EXPECT_EQ(first.json()["state"], "paused");
      expect_same(first, api_.ask("POST", path, keyed(name)));
      EXPECT_EQ(api_.post(path, "").code(), "wrong_state");
    } else {
      EXPECT_EQ(first.code(), "wrong_state");
    }
  }
  EXPECT_GT(paused, 0);
}

// What a server that is killed leaves: the effect without an answer, or neither.
class LostAnswers : public ::testing::Test {
 protected:
  Request request(const std::string& body = "{}") const {
    Request request;
    request.method = "POST";
    request.path = "/v1/maps";
    request.idempotency_key = "k";
    request.body = body;
    return request;
  }
  static Reply reply(const std::string& body) {
    Reply reply;
    reply.status = 201;
    reply.body = body;
    return reply;
  }
  ServicesUnderTest services_;
};

TEST_F(LostAnswers, WhatWasCommittedIsAnsweredByAnotherServer) {
  {
    IdempotencyKeys keys(services_.store());
    const server::Handler handler = keys.once([&](const Request&, Once& once) -> Reply {
      contract::CreateMap lab;
      lab.name = "lab";
      services_.maps().create(lab, nullptr, once.keeps<contract::Map>([&](auto& db, const auto& map) {
        once.keep(db, reply(map.name), map.name);
      }));
      throw std::runtime_error("killed");
    });
    EXPECT_THROW(handler(request()), std::runtime_error);
  }
  services_.restart();
  IdempotencyKeys keys(services_.store());
  const Reply again = keys.once([&](const Request&, Once&) { return reply("anew"); })(request());
  EXPECT_EQ(again.status, 201);
  EXPECT_EQ(again.body, "lab");
}

TEST_F(LostAnswers, WhatWasNotCommittedIsNotKept) {
  IdempotencyKeys keys(services_.store());
  const server::Handler handler = keys.once([&](const Request&, Once& once) -> Reply {
    WriteTransaction db = services_.store().write();
    once.keep(db, reply("first"), "");
    throw std::runtime_error("killed");
  });
  EXPECT_THROW(handler(request()), std::runtime_error);
  EXPECT_EQ(keys.once([&](const Request&, Once&) { return reply("anew"); })(request()).body, "anew");
}

TEST_F(LostAnswers, AKeyIsFreeAgainWhenItsRequestHasEnded) {
  IdempotencyKeys keys(services_.store());
  const server::Handler inner = keys.once([&](const Request&, Once&) { return reply("inner"); });
  const server::Handler outer = keys.once([&](const Request& same, Once&) -> Reply {
    EXPECT_EQ(code_of([&] { inner(same); }), "idempotency_in_progress");
    EXPECT_EQ(code_of([&] { inner(request("another")); }), "idempotency_in_progress");
    throw std::runtime_error("failed");
  });
  EXPECT_THROW(outer(request()), std::runtime_error);
  EXPECT_EQ(inner(request()).body, "inner");
}

}  // namespace
}  // namespace mapweld::test
