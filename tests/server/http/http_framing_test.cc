// Where a request ends, and what is refused because nobody could say.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

using HttpFraming = HttpServerTest;

TEST_F(HttpFraming, BodiesNeedALength) {
  start();
  EXPECT_THAT(exchange("POST /echo HTTP/1.1\r\nHost: x\r\n\r\n"), StartsWith("HTTP/1.1 411 "));
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nHost: x\r\n\r\n")), "length_required");
  EXPECT_THAT(exchange("POST /maybe HTTP/1.1\r\nHost: x\r\n\r\n"), HasSubstr("[]"));
  EXPECT_THAT(exchange("POST /maybe HTTP/1.1\r\nHost: x\r\nContent-Length: 2\r\n\r\nhi"), HasSubstr("[hi]"));
}

TEST_F(HttpFraming, ChunkedBodiesAreRead) {
  start();
  EXPECT_THAT(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
                       "5;ext=1\r\nhello\r\n1\r\n \r\n5\r\nworld\r\n0\r\nTrailer: x\r\n\r\n"),
              HasSubstr("hello world"));
}

TEST_F(HttpFraming, BrokenChunksAreRefused) {
  start();
  const std::string head = "POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";
  EXPECT_EQ(code(exchange(head + "-1\r\nx\r\n0\r\n\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + "0x5\r\nhello\r\n0\r\n\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + "5\r\nhelloX\r\n0\r\n\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + std::string(1000, '1') + "\r\n")), "malformed_request");
  EXPECT_EQ(code(exchange(head + "ffffffffffffffff\r\n")), "body_too_large");
}

TEST_F(HttpFraming, ARefusedBodyDoesNotBecomeTheNextRequest) {
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

TEST_F(HttpFraming, AClientThatSendsOnStillGetsItsReply) {
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

TEST_F(HttpFraming, ContentEncodingIsRefused) {
  start();
  EXPECT_EQ(code(exchange("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Encoding: gzip\r\nContent-Length: 3\r\n\r\nabc")),
            "unsupported_media_type");
}

TEST_F(HttpFraming, MalformedHeadsAreRefused) {
  start();
  for (const char* head : {
           "GET /hello HTTP/1.1\nHost: x\r\n\r\n",                                               // a bare line feed
           "GET /hello HTTP/1.1\r\nHost: x\r\n folded: 1\r\n\r\n",                               // folded
           "GET /hello HTTP/1.1\r\nHost: x\r\n: x\r\n\r\n",                                      // nameless
           "GET /hello HTTP/1.1\r\nHost: x\r\nBad Name: x\r\n\r\n",                              // no token
           "GET /hello HTTP/1.1\r\nHost: x\r\nnothing\r\n\r\n",                                  // no colon
           "POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\nx",  // contradiction
           "POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\n",  // likewise
           "POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: gzip, chunked\r\n\r\n",
           "POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: -1\r\n\r\n",
           "POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: +1\r\n\r\nx", "GET /hello HTTP/3.0\r\nHost: x\r\n\r\n",
           "FETCH /hello HTTP/1.1\r\nHost: x\r\n\r\n", "GET  /hello HTTP/1.1\r\nHost: x\r\n\r\n",
           "GET /hel lo HTTP/1.1\r\nHost: x\r\n\r\n",
           "GET /hello HTTP/1.1\r\n\r\n",                        // for no host
           "GET /hello HTTP/1.1\r\nHost: x\r\nHost: x\r\n\r\n",  // for two
           "\x16\x03\x01\r\n\r\n",                               // TLS, or something
       }) {
    const std::string reply = exchange(head);
    EXPECT_THAT(reply, StartsWith("HTTP/1.1 400 ")) << head;
    EXPECT_EQ(code(reply), "malformed_request") << head;
  }
  EXPECT_TRUE(client().Get("/hello"));
}

TEST_F(HttpFraming, ABodyIsAskedForOnlyWhenItIsWanted) {
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

}  // namespace
}  // namespace mapweld::server
