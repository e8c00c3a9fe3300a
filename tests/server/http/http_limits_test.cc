// What the server takes at most: sizes, times, connections; and how it stops.
#include <chrono>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

using HttpLimits = HttpServerTest;

TEST_F(HttpLimits, BodiesHaveALimitHoweverTheyAreFramed) {
  HttpOptions options;
  options.max_body_bytes = 1000;
  options.max_json_bytes = 100;
  start(options);
  EXPECT_THAT(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\n" + std::string(1000, 'x')),
              StartsWith("HTTP/1.1 200 "));
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 1001\r\n\r\n")), "body_too_large");
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999999999999\r\n\r\n")),
            "malformed_request");
  std::string chunked = "POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 11; ++i) chunked += "64\r\n" + std::string(100, 'x') + "\r\n";
  EXPECT_EQ(code(exchange(chunked + "0\r\n\r\n")), "body_too_large");
  EXPECT_EQ(code(exchange("POST /json HTTP/1.1\r\nHost: x\r\nContent-Length: 101\r\n\r\n")), "body_too_large");
}

TEST_F(HttpLimits, AllBodiesTogetherHaveALimit) {
  HttpOptions options;
  options.max_bodies_bytes = 1000;
  start(options);
  auto http = client();
  EXPECT_EQ(http.Post("/echo", std::string(900, 'x'), "text/plain")->status, 200);
  const auto busy = http.Post("/echo", std::string(1001, 'x'), "text/plain");
  EXPECT_EQ(busy->status, 503);
  EXPECT_EQ(busy->get_header_value("Retry-After"), "1");
  EXPECT_EQ(http.Post("/echo", std::string(900, 'x'), "text/plain")->status, 200);  // given back
}

TEST_F(HttpLimits, HeadsHaveALimit) {
  start();
  // One long field, many fields, and a line that never ends.
  EXPECT_EQ(code(exchange("GET /hello HTTP/1.1\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n")), "headers_too_large");
  std::string many = "GET /hello HTTP/1.1\r\n";
  for (int i = 0; i < 5000; ++i) many += "X" + std::to_string(i) + ": 1\r\n";
  EXPECT_EQ(code(exchange(many + "\r\n")), "headers_too_large");
  EXPECT_EQ(code(exchange(std::string(100'000, 'G'))), "headers_too_large");
  EXPECT_EQ(code(exchange("GET /" + std::string(9'000, 'x') + " HTTP/1.1\r\nHost: x\r\n\r\n")), "uri_too_long");
}

TEST_F(HttpLimits, SlowClientsAreGivenUp) {
  HttpOptions options;
  options.connection.head_timeout_ms = 200;
  options.connection.body_idle_timeout_ms = 200;
  start(options);
  EXPECT_EQ(code(exchange("GET /hello HTTP/1.1\r\nHost: ")), "request_timeout");
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nContent-Length: 10\r\n\r\nabc")), "request_timeout");
}

TEST_F(HttpLimits, IdleConnectionsGiveTheirThreadToThoseThatWait) {
  HttpOptions options;
  options.threads = 2;
  options.connection.idle_timeout_ms = 60'000;
  start(options);
  RawClient idle_1(port_);
  RawClient idle_2(port_);
  for (RawClient* idle : {&idle_1, &idle_2}) {
    idle->send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
    EXPECT_THAT(idle->receive(), HasSubstr("hello"));
  }
  const auto started = std::chrono::steady_clock::now();
  EXPECT_TRUE(client().Get("/hello"));
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(30));
}

TEST_F(HttpLimits, TurnsConnectionsAwayWhenTooManyWait) {
  HttpOptions options;
  options.threads = 1;
  options.max_waiting = 1;
  start(options);
  RawClient working(port_);
  working.send("GET /slow HTTP/1.1\r\nHost: x\r\n\r\n");
  while (slow_ == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  RawClient waiting(port_);
  waiting.send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  RawClient refused(port_);
  const std::string reply = refused.receive();
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 503 "));
  EXPECT_EQ(code(reply), "busy");
  EXPECT_THAT(working.receive(), HasSubstr("slow"));
  EXPECT_THAT(waiting.receive(), HasSubstr("hello"));
}

TEST_F(HttpLimits, DrainingFinishesWhatIsUnderWay) {
  start();
  std::string reply;
  std::thread request([&] { reply = exchange("GET /slow HTTP/1.1\r\nHost: x\r\n\r\n"); });
  RawClient idle(port_);
  idle.send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  idle.receive();
  while (slow_ == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  stop();
  request.join();
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(reply, HasSubstr("Connection: close"));
  EXPECT_TRUE(idle.closed_within(5));
  EXPECT_THROW(RawClient{port_}, std::runtime_error);
}

}  // namespace
}  // namespace mapweld::server
