#include "server/http/http_server.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/contract/json.h"
#include "client/contract/problem.h"
#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

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
  EXPECT_EQ(wrong->get_header_value("Allow"), "GET, HEAD, OPTIONS");
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

// The head of a GET's answer, but for its request id.
std::string head_of(std::string reply) {
  reply.resize(reply.find("\r\n\r\n") + 4);
  const std::size_t id = reply.find("X-Request-Id");
  return reply.erase(id, reply.find("\r\n", id) + 2 - id);
}

TEST_F(HttpServerTest, HeadHasTheHeadOfGetAndNoBody) {
  start();
  for (const std::string path : {"/hello", "/stream", "/fail", "/nothing", "/query?b=1"}) {
    const std::string rest = " " + path + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n";
    RawClient raw(port_);
    raw.send("HEAD" + rest);
    std::string reply = raw.receive_some();
    EXPECT_THAT(reply, EndsWith("\r\n\r\n")) << path;
    EXPECT_EQ(head_of(reply), head_of(exchange("GET" + rest))) << path;
    EXPECT_TRUE(raw.closed_within(10)) << path;
  }
  EXPECT_THAT(exchange("HEAD /hello HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"),
              HasSubstr("Content-Length: 5\r\n"));
}

TEST_F(HttpServerTest, HeadOfAnEventStreamListensToNothing) {
  start();
  RawClient raw(port_);
  raw.send("HEAD /events HTTP/1.1\r\nHost: x\r\n\r\nGET /hello HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(raw.receive(), HasSubstr("Content-Type: text/event-stream"));
  EXPECT_THAT(raw.receive(), HasSubstr("hello"));
  EXPECT_FALSE(events_->push("nobody hears this"));
}

TEST_F(HttpServerTest, OptionsSayWhatAPathAnswers) {
  start();
  const std::string reply = exchange("OPTIONS /echo HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 204 "));
  EXPECT_THAT(reply, HasSubstr("Allow: POST, OPTIONS\r\n"));
  EXPECT_THAT(reply, ::testing::Not(HasSubstr("Content-Length")));
  EXPECT_THAT(exchange("OPTIONS /nothing HTTP/1.1\r\nHost: x\r\n\r\n"), StartsWith("HTTP/1.1 404 "));
}

TEST_F(HttpServerTest, StreamsWholeBodies) {
  start();
  const auto reply = client().Get("/stream");
  ASSERT_TRUE(reply);
  EXPECT_EQ(std::count(reply->body.begin(), reply->body.end(), '\n'), 50'000);
  EXPECT_THAT(reply->body, EndsWith("line 49999\n"));
}

TEST_F(HttpServerTest, AStreamThatFailsIsNotTakenForWhole) {
  start();
  const auto reply = client().Get("/broken-stream");
  EXPECT_FALSE(reply);  // the connection breaks off inside the chunked body
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
