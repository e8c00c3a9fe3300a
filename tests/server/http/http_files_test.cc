// Files as replies, whole and in part, and bodies that become files.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class HttpFilesTest : public HttpServerTest {
 protected:
  void give(const std::string& bytes) { std::ofstream(folder_.path() / "given", std::ios::binary) << bytes; }
  std::string ask(const std::string& fields) const {
    return exchange("GET /file HTTP/1.1\r\nHost: x\r\n" + fields + "\r\n");
  }
  static std::string body(const std::string& reply) { return reply.substr(reply.find("\r\n\r\n") + 4); }
  std::size_t files() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.path())) ++count;
    return count;
  }
};

TEST_F(HttpFilesTest, AFileHasItsLength) {
  std::string large;
  while (large.size() < 1'000'000) large += std::to_string(large.size()) + " ";
  give(large);
  start();
  const std::string reply = ask("");
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(reply, HasSubstr("Content-Length: " + std::to_string(large.size()) + "\r\n"));
  EXPECT_THAT(reply, HasSubstr("Accept-Ranges: bytes\r\n"));
  EXPECT_THAT(reply, Not(HasSubstr("chunked")));
  EXPECT_TRUE(body(reply) == large);
  give("");
  EXPECT_THAT(ask(""), HasSubstr("Content-Length: 0\r\n"));
}

TEST_F(HttpFilesTest, RangesArePartsOfIt) {
  give("0123456789");
  start();
  const std::string part = ask("Range: bytes=2-4\r\n");
  EXPECT_THAT(part, StartsWith("HTTP/1.1 206 "));
  EXPECT_THAT(part, HasSubstr("Content-Range: bytes 2-4/10\r\n"));
  EXPECT_THAT(part, HasSubstr("Content-Length: 3\r\n"));
  EXPECT_EQ(body(part), "234");
  EXPECT_EQ(body(ask("Range: bytes=7-\r\n")), "789");
  EXPECT_EQ(body(ask("Range: bytes=7-700\r\n")), "789");
  EXPECT_EQ(body(ask("Range: bytes=-3\r\n")), "789");
  EXPECT_EQ(body(ask("Range: bytes=-300\r\n")), "0123456789");
  EXPECT_EQ(body(ask("Range: bytes=0-0\r\n")), "0");
}

TEST_F(HttpFilesTest, WhatIsNoRangeIsIgnoredAndOneBeyondTheEndRefused) {
  give("0123456789");
  start();
  for (const char* range :
       {"bytes=4-2", "bytes=", "bytes=-", "bytes=x-3", "lines=1-2", "bytes=1-2,4-5", "bytes=1-2x"}) {
    EXPECT_THAT(ask(std::string("Range: ") + range + "\r\n"), StartsWith("HTTP/1.1 200 ")) << range;
  }
  EXPECT_EQ(code(ask("Range: bytes=10-\r\n")), "range_not_satisfiable");
  EXPECT_EQ(code(ask("Range: bytes=-0\r\n")), "range_not_satisfiable");
  EXPECT_THAT(ask("Range: bytes=10-\r\n"), HasSubstr("Content-Range: bytes */10\r\n"));
}

TEST_F(HttpFilesTest, APartOfAnotherStateIsNotSent) {
  give("0123456789");
  start();
  EXPECT_EQ(body(ask("Range: bytes=2-4\r\nIf-Range: \"v1\"\r\n")), "234");
  EXPECT_EQ(body(ask("Range: bytes=2-4\r\nIf-Range: \"v0\"\r\n")), "0123456789");
}

TEST_F(HttpFilesTest, ABodyBecomesAFileThatIsGoneAfterwards) {
  HttpOptions options;
  options.max_body_bytes = 10;
  options.max_bodies_bytes = 10;
  start(options);
  const std::string large(300'000, 'x');
  EXPECT_EQ(body(exchange("POST /file HTTP/1.1\r\nHost: x\r\nContent-Length: 300000\r\n\r\n" + large)),
            "0 and " + large);
  EXPECT_EQ(body(exchange("POST /file HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
                          "3\r\none\r\n3\r\ntwo\r\n0\r\n\r\n")),
            "0 and onetwo");
  EXPECT_EQ(code(exchange("POST /file HTTP/1.1\r\nHost: x\r\n\r\n")), "length_required");
  {
    RawClient gone(port_);
    gone.send("POST /file HTTP/1.1\r\nHost: x\r\nContent-Length: 300000\r\n\r\nbeginning");
    while (files() == 0) std::this_thread::yield();
  }
  for (int i = 0; i < 1000 && files() > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(files(), 0u);
}

TEST_F(HttpFilesTest, ABodyThatFindsNoRoomIsAProblem) {
  HttpOptions options;
  start(options);
  std::filesystem::remove_all(folder_.path());
  EXPECT_EQ(code(exchange("POST /file HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\none")), "internal_error");
}

}  // namespace
}  // namespace mapweld::server
