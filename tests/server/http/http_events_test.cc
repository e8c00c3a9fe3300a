// Replies without an end.
#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class HttpEvents : public HttpServerTest {
 protected:
  // What arrives until `end` does.
  static std::string until(RawClient& raw, const std::string& end) {
    std::string text;
    for (int i = 0; i < 100 && text.find(end) == std::string::npos; ++i) text += raw.receive_some();
    return text;
  }
};

TEST_F(HttpEvents, AreWrittenAsTheyCome) {
  HttpOptions options;
  options.threads = 1;
  start(options);
  RawClient raw(port_);
  raw.send("GET /events HTTP/1.1\r\nHost: x\r\nLast-Event-ID: 17\r\n\r\n");
  const std::string head = until(raw, "last id 17.");
  EXPECT_THAT(head, HasSubstr("Content-Type: text/event-stream\r\n"));
  EXPECT_THAT(head, HasSubstr("Transfer-Encoding: chunked\r\n"));
  auto soonest = std::chrono::steady_clock::duration::max();  // a busy machine may make some of them late
  for (int i = 0; i < 20; ++i) {
    const auto told = std::chrono::steady_clock::now();
    events_->push("event " + std::to_string(i) + ".\n");
    EXPECT_THAT(until(raw, "event " + std::to_string(i) + "."), Not(HasSubstr("timeout")));
    soonest = std::min(soonest, std::chrono::steady_clock::now() - told);
  }
  EXPECT_LT(soonest, std::chrono::milliseconds(250));
  EXPECT_TRUE(client().Get("/hello"));  // it holds no thread
  events_->push("last.\n");
  events_->end();
  EXPECT_THAT(until(raw, "\r\n0\r\n\r\n"), HasSubstr("last."));
  raw.send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(raw.receive(), HasSubstr("hello"));
}

TEST_F(HttpEvents, ACommentComesWhenThereIsNothingElse) {
  HttpOptions options;
  options.connection.event_heartbeat_ms = 100;
  start(options);
  RawClient raw(port_);
  raw.send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
  until(raw, "last id");
  EXPECT_THAT(until(raw, ": \n\n"), HasSubstr(": \n\n"));
}

TEST_F(HttpEvents, AClientThatGoesIsNoticed) {
  start();
  {
    RawClient raw(port_);
    raw.send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
    until(raw, "last id");
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_FALSE(events_->push("x"));  // before anything had to be written
}

TEST_F(HttpEvents, AClientThatDoesNotReadIsGivenUp) {
  HttpOptions options;
  options.connection.write_timeout_ms = 300;
  start(options);
  RawClient raw(port_);
  raw.send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
  until(raw, "last id");
  const std::string text(100'000, 'x');
  bool listened = true;
  for (int i = 0; i < 2000 && listened; ++i) {
    listened = events_->push(text);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_FALSE(listened);
}

TEST_F(HttpEvents, EndWhenTheServerDrains) {
  start();
  RawClient raw(port_);
  raw.send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
  until(raw, "last id");
  const auto started = std::chrono::steady_clock::now();
  stop();
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(3));
  EXPECT_THAT(until(raw, "0\r\n\r\n"), HasSubstr("0\r\n\r\n"));
  EXPECT_TRUE(raw.closed_within(5));
}

TEST_F(HttpEvents, AClientOfHttp10GetsThemWithoutChunks) {
  start();
  RawClient raw(port_);
  raw.send("GET /events HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
  const std::string head = until(raw, "last id .\n");
  EXPECT_THAT(head, Not(HasSubstr("chunked")));
  EXPECT_THAT(head, HasSubstr("\r\n\r\nlast id .\n"));
  events_->end();
  EXPECT_TRUE(raw.closed_within(5));
}

}  // namespace
}  // namespace mapweld::server
