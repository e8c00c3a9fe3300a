// Events over HTTP: what a listener hears of uploads and merges, and when.
#include <algorithm>
#include <chrono>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/http/raw_client.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Listens to a path.
class Listener {
 public:
  Listener(const ApiUnderTest& api, const std::string& path, const std::string& last_id = "") : raw_(api.port()) {
    raw_.send("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n" +
              (last_id.empty() ? "" : "Last-Event-ID: " + last_id + "\r\n") + "\r\n");
    until(": mapweld");
  }
  // All that was heard, once it has `end`.
  const std::string& until(const std::string& end) {
    while (heard_.find(end) == std::string::npos) {
      const std::string some = raw_.receive_some();
      if (some == "timeout") break;
      heard_ += some;
    }
    EXPECT_THAT(heard_, HasSubstr(end));
    return heard_;
  }
  // The `which`th id from the end.
  std::string id_from_end(int which) const {
    std::size_t at = heard_.size();
    for (int i = 0; i < which; ++i) at = heard_.rfind("id: ", at - 1);
    return heard_.substr(at + 4, heard_.find('\n', at) - at - 4);
  }

 private:
  RawClient raw_;
  std::string heard_;
};

class EventsTest : public ::testing::Test {
 protected:
  void make_maps() {
    for (const char* map : {"a", "b"}) {
      api_.post("/v1/maps", std::string(R"({"name":")") + map + "\"}");
      for (int step = 0; step < 4; ++step) {
        api_.post_image("/v1/maps/" + std::string(map) + "/images?name=" + std::to_string(step), photo_jpeg(1, step));
      }
    }
  }

  ApiUnderTest api_;
};

TEST_F(EventsTest, MapsAndImagesAreToldAtOnce) {
  Listener all(api_, "/v1/events");
  api_.post("/v1/maps", R"({"name":"a"})");
  EXPECT_THAT(all.until("created"), HasSubstr("event: map\ndata: {\"map\":\"a\",\"change\":\"created\"}\n\n"));
  api_.post_image("/v1/maps/a/images?name=first", photo_jpeg(1, 0));
  const auto answered = std::chrono::steady_clock::now();
  EXPECT_THAT(all.until("\"name\":\"first\""),
              HasSubstr("event: image\ndata: {\"map\":\"a\",\"outcome\":\"inserted\",\"vertex\":0"));
  auto soonest = std::chrono::steady_clock::now() - answered;  // a busy machine may make some of them late
  for (const std::string name : {"second", "third", "fourth"}) {
    api_.post_image("/v1/maps/a/images?name=" + name, photo_jpeg(1, 1));
    const auto then = std::chrono::steady_clock::now();
    all.until("\"name\":\"" + name + "\"");
    soonest = std::min(soonest, std::chrono::steady_clock::now() - then);
  }
  EXPECT_LT(soonest, std::chrono::milliseconds(250));
  api_.del("/v1/maps/a");
  all.until("deleted");
}

TEST_F(EventsTest, AMergeTellsItsStatesItsEdgesAndItsEnd) {
  make_maps();
  Listener all(api_, "/v1/events");
  api_.post("/v1/merges", R"({"maps":["a","b"],"name":"ab","method":"quickconnect"})");
  const std::string heard = all.until("event: done");
  EXPECT_THAT(heard, HasSubstr("\"state\":\"queued\""));
  EXPECT_THAT(heard, HasSubstr("\"state\":\"running\""));
  EXPECT_THAT(heard, HasSubstr("\"state\":\"completed\""));
  EXPECT_THAT(heard, HasSubstr("event: phase"));
  EXPECT_THAT(heard, HasSubstr("event: progress"));
  std::size_t edges = 0;
  for (std::size_t at = heard.find("event: edge"); at != std::string::npos; at = heard.find("event: edge", at + 1)) {
    ++edges;
  }
  EXPECT_GT(edges, 0u);
  EXPECT_EQ(edges, api_.get("/v1/merges/1").json()["edges"].get<std::size_t>());
}

TEST_F(EventsTest, AMergeWhoseMapHasAnotherNameIsToldUnderIt) {
  make_maps();
  api_.post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})");
  api_.finished_merge(1);
  EXPECT_EQ(api_.ask("PATCH", "/v1/maps/ab", {}, R"({"name":"both"})").status, 200);
  Listener all(api_, "/v1/events");
  api_.post("/v1/merges/1/restart", "");
  EXPECT_THAT(all.until("event: done"), Not(HasSubstr("\"map\":\"ab\"")));
}

TEST_F(EventsTest, WhatAGuardConfirmsIsTold) {
  make_maps();
  Listener all(api_, "/v1/events");
  api_.post("/v1/merges",
            R"({"maps":["a","b"],"name":"ab","method":"quickconnect","parameters":{"alias_guard":true}})");
  const std::string heard = all.until("event: done");
  std::size_t standing = 0;
  for (std::size_t at = heard.find("event: "); at != std::string::npos; at = heard.find("event: ", at + 1)) {
    if (heard.compare(at, 16, "event: confirmed") == 0) ++standing;
    if (heard.compare(at, 14, "event: revoked") == 0) --standing;
  }
  EXPECT_EQ(standing, api_.get("/v1/merges/1").json()["edge_counts"]["confirmed"].get<std::size_t>());
}

TEST_F(EventsTest, AMergesStreamBeginsWithHowItStands) {
  make_maps();
  api_.post("/v1/merges", R"({"maps":["a","b"],"name":"ab"})");
  api_.finished_merge(1);
  Listener late(api_, "/v1/merges/1/events");
  EXPECT_THAT(late.until("event: done"), HasSubstr("event: state\ndata: {\"merge\":1,\"map\":\"ab\""));
  EXPECT_EQ(api_.get("/v1/merges/9/events").code(), "no_such_merge");
}

TEST_F(EventsTest, AMergesStreamIsTakenUpAtAStep) {
  make_maps();
  Listener all(api_, "/v1/events");
  api_.post("/v1/merges", R"({"maps":["a","b"],"name":"ab","method":"quickconnect"})");
  all.until("event: done");
  Listener again(api_, "/v1/events", all.id_from_end(2));
  const std::string& rest = again.until("event: done");
  EXPECT_THAT(rest, Not(HasSubstr("event: reset")));
  EXPECT_THAT(rest, Not(HasSubstr("event: edge")));
  Listener unknown(api_, "/v1/merges/1/events", "999999");
  EXPECT_THAT(unknown.until("event: done"), HasSubstr("event: reset"));
}

}  // namespace
}  // namespace mapweld::test
