// Replies as the client asks for them: compressed, or not at all when it has them.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class HttpNegotiation : public HttpServerTest {
 protected:
  std::string get(const std::string& path, const std::string& fields) const {
    return exchange("GET " + path + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" + fields + "\r\n");
  }
};

TEST_F(HttpNegotiation, TextIsCompressedForThoseWhoTakeIt) {
  start();
  const std::string plain = get("/long", "");
  EXPECT_THAT(plain, HasSubstr("Vary: Accept-Encoding\r\n"));
  EXPECT_THAT(plain, HasSubstr("Content-Length: 100000\r\n"));
  const std::string gzip = get("/long", "Accept-Encoding: br, gzip;q=0.5\r\n");
  EXPECT_THAT(gzip, HasSubstr("Content-Encoding: gzip\r\n"));
  EXPECT_THAT(gzip, HasSubstr("Vary: Accept-Encoding\r\n"));
  EXPECT_LT(gzip.size(), 2000u);
  EXPECT_THAT(get("/hello", "Accept-Encoding: gzip\r\n"), Not(HasSubstr("Content-Encoding")));
  EXPECT_THAT(get("/picture", "Accept-Encoding: gzip\r\n"), Not(HasSubstr("Content-Encoding")));
  EXPECT_THAT(get("/picture", "Accept-Encoding: gzip\r\n"), Not(HasSubstr("Vary")));
}

// By a client that inflates what it gets.
TEST_F(HttpNegotiation, CompressedRepliesAreTheSame) {
  start();
  for (const char* path : {"/long", "/stream"}) {
    auto http = client();
    const auto gzip = http.Get(path, {{"Accept-Encoding", "gzip"}});
    const auto plain = http.Get(path, {{"Accept-Encoding", "identity"}});
    ASSERT_TRUE(gzip && plain) << path;
    EXPECT_EQ(gzip->get_header_value("Content-Encoding"), "gzip") << path;
    EXPECT_EQ(plain->get_header_value("Content-Encoding"), "") << path;
    EXPECT_EQ(gzip->body, plain->body) << path;
  }
  EXPECT_FALSE(client().Get("/broken-stream", {{"Accept-Encoding", "gzip"}}));
}

TEST_F(HttpNegotiation, WhatTheClientHasIsNotSentAgain) {
  start();
  const std::string first = get("/picture", "");
  EXPECT_THAT(first, HasSubstr("ETag: \"tag\"\r\n"));
  EXPECT_THAT(first, HasSubstr("Cache-Control: private, no-cache\r\n"));
  const std::string again = get("/picture", "If-None-Match: \"other\"\r\nIf-None-Match: \"tag\"\r\n");
  EXPECT_THAT(again, StartsWith("HTTP/1.1 304 Not Modified\r\n"));
  EXPECT_THAT(again, HasSubstr("ETag: \"tag\"\r\n"));
  EXPECT_THAT(again, HasSubstr("Cache-Control: private, no-cache\r\n"));
  EXPECT_THAT(again, Not(HasSubstr("Content-")));
  EXPECT_THAT(again, ::testing::EndsWith("\r\n\r\n"));
  EXPECT_THAT(get("/picture", "If-None-Match: \"other\"\r\n"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(get("/hello", "If-None-Match: *\r\n"), StartsWith("HTTP/1.1 200 "));  // it has no tag
}

TEST_F(HttpNegotiation, ACompressedReplyIsKnownByTheTagThatItCameWith) {
  start();
  const std::string gzip = get("/long", "Accept-Encoding: gzip\r\n");
  EXPECT_THAT(gzip, HasSubstr("ETag: W/\"long\"\r\n"));
  for (const char* tag : {"\"long\"", "W/\"long\""}) {
    const std::string again = get("/long", std::string("Accept-Encoding: gzip\r\nIf-None-Match: ") + tag + "\r\n");
    EXPECT_THAT(again, StartsWith("HTTP/1.1 304 ")) << tag;
    EXPECT_THAT(again, HasSubstr("Vary: Accept-Encoding\r\n"));
  }
}

}  // namespace
}  // namespace mapweld::server
