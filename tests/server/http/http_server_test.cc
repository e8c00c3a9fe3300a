#include "server/http/http_server.h"

#include <atomic>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include "client/contract/json.h"
#include "client/contract/problem.h"
#include "tests/server/http/raw_client.h"

namespace mapweld::server {
namespace {

using mapweld::test::RawClient;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// A server with a handful of routes that show what arrived.
class HttpServerTest : public ::testing::Test {
 protected:
  void start(HttpOptions options = {}) {
    options.port = 0;
    Router router;
    router.add({.method = "GET", .pattern = "/hello", .handler = [](const Request&) { return text("hello"); }});
    router.add({.method = "GET", .pattern = "/query", .query = {"a"}, .handler = [](const Request& request) {
                  return text(request.query.text("a").value_or("-"));
                }});
    router.add(
        {.method = "POST", .pattern = "/echo", .body = BodyRule::kRequired, .handler = [](const Request& request) {
           return text(request.body);
         }});
    router.add({.method = "POST",
                .pattern = "/json",
                .body = BodyRule::kRequired,
                .json_body = true,
                .handler = [](const Request& request) { return text(std::to_string(request.body.size())); }});
    router.add(
        {.method = "POST", .pattern = "/maybe", .body = BodyRule::kOptional, .handler = [](const Request& request) {
           return text("[" + request.body + "]");
         }});
    router.add({.method = "GET", .pattern = "/slow", .handler = [this](const Request&) {
                  ++slow_;
                  std::this_thread::sleep_for(std::chrono::milliseconds(300));
                  return text("slow");
                }});
    router.add({.method = "GET", .pattern = "/fail", .handler = [](const Request&) -> Reply {
                  throw std::runtime_error("the secret inside");
                }});
    router.add({.method = "GET", .pattern = "/stream", .handler = [](const Request&) {
                  Reply reply = text("");
                  reply.stream = [](const ChunkWriter& write) {
                    for (int i = 0; i < 50'000; ++i) {
                      if (!write("line " + std::to_string(i) + "\n")) return;
                    }
                  };
                  return reply;
                }});
    router.add({.method = "GET", .pattern = "/broken-stream", .handler = [](const Request&) {
                  Reply reply = text("");
                  reply.stream = [](const ChunkWriter& write) {
                    write(std::string(100'000, 'x'));
                    throw std::runtime_error("the disk went away");
                  };
                  return reply;
                }});
    server_ = std::make_unique<HttpServer>(options, std::move(router), metrics_);
    port_ = server_->bind();
    thread_ = std::thread([this] { server_->serve(); });
  }

  void TearDown() override { stop(); }

  void stop() {
    if (!thread_.joinable()) return;
    server_->drain();
    thread_.join();
  }

  static Reply text(const std::string& body) {
    Reply reply;
    reply.content_type = "text/plain";
    reply.body = body;
    return reply;
  }

  httplib::Client client() const {
    httplib::Client client("127.0.0.1", port_);
    client.set_keep_alive(true);
    return client;
  }

  // Sends `bytes` on a connection of its own.
  std::string exchange(std::string_view bytes) const {
    RawClient raw(port_);
    raw.send(bytes);
    return raw.receive();
  }

  static std::string code(const std::string& reply) {
    const std::size_t body = reply.find("\r\n\r\n");
    if (body == std::string::npos) return "no reply";
    return contract::parse_json(reply.substr(body + 4)).value("code", "");
  }

  Metrics metrics_;
  std::atomic<int> slow_{0};
  std::unique_ptr<HttpServer> server_;
  int port_ = 0;
  std::thread thread_;
};

TEST_F(HttpServerTest, ServesManyRequestsOnOneConnection) {
  start();
  RawClient raw(port_);
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(raw.send("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n"));
    const std::string reply = raw.receive();
    ASSERT_THAT(reply, StartsWith("HTTP/1.1 200 OK"));
    ASSERT_THAT(reply, HasSubstr("\r\n\r\nhello"));
  }
}

TEST_F(HttpServerTest, PipelinedRequestsAreAnsweredInOrder) {
  start();
  RawClient raw(port_);
  raw.send("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\noneGET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(raw.receive(), HasSubstr("one"));
  EXPECT_THAT(raw.receive(), HasSubstr("hello"));
}

TEST_F(HttpServerTest, EveryReplyHasARequestId) {
  start();
  auto http = client();
  const auto first = http.Get("/hello");
  const auto second = http.Get("/hello");
  EXPECT_FALSE(first->get_header_value("X-Request-Id").empty());
  EXPECT_NE(first->get_header_value("X-Request-Id"), second->get_header_value("X-Request-Id"));
  const auto own = http.Get("/nothing", {{"X-Request-Id", "my-request.7"}});
  EXPECT_EQ(own->get_header_value("X-Request-Id"), "my-request.7");
  EXPECT_EQ(contract::parse_json(own->body).value("request_id", ""), "my-request.7");
  const auto hostile = http.Get("/hello", {{"X-Request-Id", std::string(100, 'x')}});
  EXPECT_LT(hostile->get_header_value("X-Request-Id").size(), 65u);
}

TEST_F(HttpServerTest, UnknownPathsAndMethodsAreProblems) {
  start();
  auto http = client();
  const auto missing = http.Get("/nothing");
  EXPECT_EQ(missing->status, 404);
  EXPECT_EQ(missing->get_header_value("Content-Type"), "application/problem+json");
  const contract::Json problem = contract::parse_json(missing->body);
  EXPECT_EQ(problem.value("type", ""), "urn:mapweld:problem:no_such_path");
  EXPECT_EQ(problem.value("status", 0), 404);
  const auto wrong = http.Delete("/hello");
  EXPECT_EQ(wrong->status, 405);
  EXPECT_EQ(wrong->get_header_value("Allow"), "GET");
  EXPECT_EQ(contract::parse_json(wrong->body).value("code", ""), "method_not_allowed");
}

TEST_F(HttpServerTest, UnknownQueryParametersAreRefused) {
  start();
  auto http = client();
  EXPECT_EQ(http.Get("/query?a=1")->body, "1");
  EXPECT_EQ(contract::parse_json(http.Get("/query?b=1")->body).value("code", ""), "unknown_field");
}

TEST_F(HttpServerTest, AnExceptionTellsTheClientNothingOfTheInside) {
  start();
  const auto reply = client().Get("/fail");
  EXPECT_EQ(reply->status, 500);
  EXPECT_EQ(contract::parse_json(reply->body).value("code", ""), "internal_error");
  EXPECT_EQ(reply->body.find("secret"), std::string::npos);
}

TEST_F(HttpServerTest, HeadHasNoBody) {
  start();
  RawClient raw(port_);
  raw.send("HEAD /hello HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  std::string head = raw.receive();
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_TRUE(raw.closed_within(10));
}

TEST_F(HttpServerTest, StreamsWholeBodies) {
  start();
  const auto reply = client().Get("/stream");
  ASSERT_TRUE(reply);
  EXPECT_EQ(std::count(reply->body.begin(), reply->body.end(), '\n'), 50'000);
  EXPECT_THAT(reply->body, ::testing::EndsWith("line 49999\n"));
}

TEST_F(HttpServerTest, AStreamThatFailsIsNotTakenForWhole) {
  start();
  const auto reply = client().Get("/broken-stream");
  EXPECT_FALSE(reply);  // the connection breaks off inside the chunked body
  EXPECT_TRUE(client().Get("/hello"));
}

TEST_F(HttpServerTest, BodiesNeedALength) {
  start();
  EXPECT_THAT(exchange("POST /echo HTTP/1.1\r\nHost: x\r\n\r\n"), StartsWith("HTTP/1.1 411 "));
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nHost: x\r\n\r\n")), "length_required");
  EXPECT_THAT(exchange("POST /maybe HTTP/1.1\r\nHost: x\r\n\r\n"), HasSubstr("[]"));
  EXPECT_THAT(exchange("POST /maybe HTTP/1.1\r\nHost: x\r\nContent-Length: 2\r\n\r\nhi"), HasSubstr("[hi]"));
}

TEST_F(HttpServerTest, ChunkedBodiesAreRead) {
  start();
  EXPECT_THAT(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
                       "5;ext=1\r\nhello\r\n1\r\n \r\n5\r\nworld\r\n0\r\nTrailer: x\r\n\r\n"),
              HasSubstr("hello world"));
}

TEST_F(HttpServerTest, BrokenChunksAreRefused) {
  start();
  const std::string head = "POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";
  EXPECT_EQ(code(exchange(head + "-1\r\nx\r\n0\r\n\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + "0x5\r\nhello\r\n0\r\n\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + "5\r\nhelloX\r\n0\r\n\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + std::string(1000, '1') + "\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + "ffffffffffffffff\r\n")), "body_too_large");
}

TEST_F(HttpServerTest, BodiesHaveALimitHoweverTheyAreFramed) {
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

TEST_F(HttpServerTest, ARefusedBodyDoesNotBecomeTheNextRequest) {
  HttpOptions options;
  options.max_body_bytes = 10;
  start(options);
  RawClient raw(port_);
  raw.send("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\nGET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  const std::string reply = raw.receive();
  EXPECT_EQ(code(reply), "body_too_large");
  EXPECT_THAT(reply, HasSubstr("Connection: close"));
  EXPECT_TRUE(raw.closed_within(10));
  EXPECT_EQ(raw.receive(), "");
  // A GET that brings a body, likewise.
  RawClient get(port_);
  get.send("GET /hello HTTP/1.1\r\nHost: x\r\nContent-Length: 30\r\n\r\nGET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(get.receive(), HasSubstr("Connection: close"));
  EXPECT_TRUE(get.closed_within(10));
}

TEST_F(HttpServerTest, AClientThatSendsOnStillGetsItsReply) {
  HttpOptions options;
  options.max_body_bytes = 1000;
  start(options);
  auto http = client();
  const auto reply = http.Post("/echo", std::string(3'000'000, 'x'), "image/jpeg");
  ASSERT_TRUE(reply) << to_string(reply.error());
  EXPECT_EQ(reply->status, 413);
  http.set_keep_alive(false);  // "Connection: close"
  const auto last = http.Post("/echo", std::string(3'000'000, 'x'), "image/jpeg");
  ASSERT_TRUE(last) << to_string(last.error());
  EXPECT_EQ(last->status, 413);
}

TEST_F(HttpServerTest, AllBodiesTogetherHaveALimit) {
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

TEST_F(HttpServerTest, ContentEncodingIsRefused) {
  start();
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Encoding: gzip\r\nContent-Length: 3\r\n\r\nabc")),
            "unsupported_media_type");
}

TEST_F(HttpServerTest, HeadsHaveALimit) {
  start();
  // One long field, many fields, and a line that never ends.
  EXPECT_EQ(code(exchange("GET /hello HTTP/1.1\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n")), "headers_too_large");
  std::string many = "GET /hello HTTP/1.1\r\n";
  for (int i = 0; i < 5000; ++i) many += "X" + std::to_string(i) + ": 1\r\n";
  EXPECT_EQ(code(exchange(many + "\r\n")), "headers_too_large");
  EXPECT_EQ(code(exchange(std::string(100'000, 'G'))), "headers_too_large");
  EXPECT_EQ(code(exchange("GET /" + std::string(9'000, 'x') + " HTTP/1.1\r\nHost: x\r\n\r\n")), "uri_too_long");
}

TEST_F(HttpServerTest, MalformedHeadsAreRefused) {
  start();
  for (const char* head : {
           "GET /hello HTTP/1.1\nHost: x\r\n\r\n",                                            // a bare line feed
           "GET /hello HTTP/1.1\r\nHost: x\r\n folded: 1\r\n\r\n",                            // folded
           "GET /hello HTTP/1.1\r\n: x\r\n\r\n",                                              // nameless
           "GET /hello HTTP/1.1\r\nBad Name: x\r\n\r\n",                                      // no token
           "GET /hello HTTP/1.1\r\nnothing\r\n\r\n",                                          // no colon
           "POST /echo HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\nx",          // contradiction
           "POST /echo HTTP/1.1\r\nContent-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\n",  // likewise
           "POST /echo HTTP/1.1\r\nTransfer-Encoding: gzip, chunked\r\n\r\n",
           "POST /echo HTTP/1.1\r\nContent-Length: -1\r\n\r\n", "POST /echo HTTP/1.1\r\nContent-Length: +1\r\n\r\nx",
           "GET /hello HTTP/3.0\r\n\r\n", "FETCH /hello HTTP/1.1\r\n\r\n",
           "\x16\x03\x01\r\n\r\n",  // TLS, or something
       }) {
    const std::string reply = exchange(head);
    EXPECT_THAT(reply, StartsWith("HTTP/1.1 400 ")) << head;
    EXPECT_EQ(code(reply), "malformed_request") << head;
  }
  EXPECT_TRUE(client().Get("/hello"));
}

TEST_F(HttpServerTest, RangesAreIgnored) {
  start();
  std::string ranges = "bytes=0-0";
  for (int i = 0; i < 1500; ++i) ranges += ",0-0";
  const std::string reply = exchange("GET /hello HTTP/1.1\r\nHost: x\r\nRange: " + ranges + "\r\n\r\n");
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(reply, HasSubstr("\r\n\r\nhello"));
}

TEST_F(HttpServerTest, RepliesAreNotCompressed) {
  start();
  const std::string reply = exchange("GET /hello HTTP/1.1\r\nHost: x\r\nAccept-Encoding: gzip, br\r\n\r\n");
  EXPECT_EQ(reply.find("Content-Encoding"), std::string::npos);
}

TEST_F(HttpServerTest, ABodyIsAskedForOnlyWhenItIsWanted) {
  HttpOptions options;
  options.max_body_bytes = 10;
  start(options);
  const std::string expect = "Host: x\r\nExpect: 100-continue\r\n";
  RawClient wanted(port_);
  wanted.send("POST /echo HTTP/1.1\r\n" + expect + "Content-Length: 2\r\n\r\n");
  EXPECT_THAT(wanted.receive(), StartsWith("HTTP/1.1 100 "));
  wanted.send("hi");
  EXPECT_THAT(wanted.receive(), HasSubstr("hi"));
  EXPECT_THAT(exchange("POST /echo HTTP/1.1\r\n" + expect + "Content-Length: 11\r\n\r\n"), StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(exchange("POST /nothing HTTP/1.1\r\n" + expect + "Content-Length: 2\r\n\r\n"),
              StartsWith("HTTP/1.1 404 "));
}

TEST_F(HttpServerTest, SlowClientsAreGivenUp) {
  HttpOptions options;
  options.connection.head_timeout_ms = 200;
  options.connection.body_idle_timeout_ms = 200;
  start(options);
  EXPECT_EQ(code(exchange("GET /hello HTTP/1.1\r\nHost: ")), "request_timeout");
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nContent-Length: 10\r\n\r\nabc")), "request_timeout");
}

TEST_F(HttpServerTest, IdleConnectionsGiveTheirThreadToThoseThatWait) {
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

TEST_F(HttpServerTest, TurnsConnectionsAwayWhenTooManyWait) {
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

TEST_F(HttpServerTest, DrainingFinishesWhatIsUnderWay) {
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

TEST_F(HttpServerTest, ATakenPortIsSaid) {
  start();
  HttpOptions options;
  options.port = port_;
  Metrics metrics;
  HttpServer second(options, Router{}, metrics);
  try {
    second.bind();
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("Address already in use"));
  }
}

TEST_F(HttpServerTest, RequestsAreCounted) {
  start();
  auto http = client();
  http.Get("/hello");
  http.Get("/hello?nonsense=1");
  http.Get("/nothing");
  stop();  // a request is counted after its reply was sent
  const std::string text = metrics_.prometheus_text();
  EXPECT_THAT(text, HasSubstr("mapweld_http_requests_total{method=\"GET\",route=\"/hello\",status=\"200\"} 1"));
  EXPECT_THAT(text, HasSubstr("mapweld_http_requests_total{method=\"GET\",route=\"/hello\",status=\"400\"} 1"));
  EXPECT_THAT(text, HasSubstr("mapweld_http_requests_total{method=\"GET\",route=\"none\",status=\"404\"} 1"));
}

}  // namespace
}  // namespace mapweld::server
