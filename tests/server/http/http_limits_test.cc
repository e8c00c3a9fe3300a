// What the server takes at most: sizes, times, connections; and how it stops.
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

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
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 10\r\n\r\nabc")), "request_timeout");
}

TEST_F(HttpLimits, ABodyMustComeAtALeastRateOnTheWhole) {
  HttpOptions options;
  options.connection.rate_grace_ms = 300;
  options.connection.min_rate_bytes_per_s = 1000;
  start(options);
  const std::string head = "POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\n";
  RawClient slow(port_);  // 3 bytes each 50 ms: never still, 60 a second
  slow.send(head);
  bool open = true;
  for (int i = 0; i < 100 && open; ++i) open = slow.send("abc") && !slow.closed_within(0.05);
  EXPECT_FALSE(open);
  RawClient fast(port_);  // 100 bytes each 50 ms: 2,000 a second
  fast.send(head);
  for (int i = 0; i < 10; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    fast.send(std::string(100, 'x'));
  }
  EXPECT_THAT(fast.receive(), StartsWith("HTTP/1.1 200 "));
}

// Each of these held a thread once.
TEST_F(HttpLimits, SlowClientsHoldNoThread) {
  HttpOptions options;
  options.threads = 1;
  start(options);
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 50; ++i) {
    slow.push_back(std::make_unique<RawClient>(port_));
    slow.back()->send("GET /hel");
    slow.push_back(std::make_unique<RawClient>(port_));
    slow.back()->send("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\nabc");
    slow.push_back(std::make_unique<RawClient>(port_));
    slow.back()->send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
    EXPECT_THAT(slow.back()->receive(), HasSubstr("hello"));
  }
  const auto started = std::chrono::steady_clock::now();
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(client().Get("/hello"));
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(4));
  slow[0]->send("lo HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(slow[0]->receive(), HasSubstr("hello"));
  slow[1]->send(std::string(97, 'x'));
  EXPECT_THAT(slow[1]->receive(), HasSubstr("abcx"));
}

TEST_F(HttpLimits, AReaderWhoStandsStillHoldsNoThread) {
  HttpOptions options;
  options.threads = 2;
  options.connection.write_timeout_ms = 500;
  start(options);
  RawClient still_1(port_);
  RawClient still_2(port_);
  for (RawClient* still : {&still_1, &still_2}) still->send("GET /endless HTTP/1.1\r\nHost: x\r\n\r\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_TRUE(client().Get("/hello"));
  EXPECT_EQ(code(exchange("GET /endless HTTP/1.1\r\nHost: x\r\n\r\n")), "busy");  // as many as threads
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  std::string reply;
  while (!reply.starts_with("HTTP/1.1 200 ") && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    reply = exchange("HEAD /endless HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  }
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 200 "));  // both were given up
  EXPECT_LT(pieces_, 1'000);                        // what the kernel's buffers hold, not all there is
}

TEST_F(HttpLimits, AReaderWhoGoesOnIsNotGivenUp) {
  HttpOptions options;
  options.connection.write_timeout_ms = 500;
  start(options);
  RawClient reader(port_);
  reader.send("GET /endless HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_FALSE(reader.closed_within(2));
}

TEST_F(HttpLimits, TheConnectionIdleForLongestMakesRoom) {
  HttpOptions options;
  options.max_connections = 3;
  options.connection.idle_timeout_ms = 60'000;
  start(options);
  RawClient head(port_);  // busy, if slowly
  head.send("GET /hel");
  RawClient idle_1(port_);
  idle_1.send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(idle_1.receive(), HasSubstr("hello"));
  RawClient idle_2(port_);
  idle_2.send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(idle_2.receive(), HasSubstr("hello"));
  EXPECT_TRUE(client().Get("/hello"));
  EXPECT_TRUE(idle_1.closed_within(5));
  idle_2.send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(idle_2.receive(), HasSubstr("hello"));
}

TEST_F(HttpLimits, ConnectionsThatFindNoRoomAreTold) {
  HttpOptions options;
  options.max_connections = 2;
  start(options);
  RawClient head_1(port_);
  RawClient head_2(port_);
  head_1.send("GET /hel");
  head_2.send("GET /hel");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  RawClient refused(port_);
  const std::string reply = refused.receive();
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 503 "));
  EXPECT_EQ(code(reply), "busy");
  head_1.send("lo HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(head_1.receive(), HasSubstr("hello"));
}

TEST_F(HttpLimits, TurnsRequestsAwayWhenTooManyWait) {
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
  const std::string reply = exchange("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 503 "));
  EXPECT_EQ(code(reply), "busy");
  EXPECT_THAT(exchange("GET /at-once HTTP/1.1\r\nHost: x\r\n\r\n"), HasSubstr("at once"));  // takes no thread
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
