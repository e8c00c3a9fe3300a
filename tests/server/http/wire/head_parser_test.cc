#include "server/http/wire/head_parser.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/contract/problem.h"

namespace mapweld::server {
namespace {

using contract::ContractError;
using ::testing::ElementsAre;
using ::testing::Pair;

constexpr std::size_t kMaxBytes = 1000;
constexpr std::size_t kMaxTarget = 100;

// The head in `bytes`, which arrive `at_once` at a time; what follows it is put into `rest`.
Head parse(std::string_view bytes, std::size_t at_once, std::string* rest = nullptr) {
  HeadParser parser(kMaxBytes, kMaxTarget);
  while (!bytes.empty()) {
    std::string_view piece = bytes.substr(0, at_once);
    bytes.remove_prefix(piece.size());
    const bool whole = parser.take(piece);
    if (whole && rest) *rest = std::string(piece) + std::string(bytes);
    if (whole) return parser.head();
    EXPECT_TRUE(piece.empty());
  }
  throw std::runtime_error("not whole");
}

std::string code_of(std::string_view bytes) {
  try {
    parse(bytes, 7);
  } catch (const ContractError& error) {
    return std::string(error.code().word());
  } catch (const std::runtime_error&) {
    return "not whole";
  }
  return "whole";
}

TEST(HeadParser, IsTheSameHoweverItArrives) {
  const std::string bytes =
      "\r\n\r\nPOST /a%20b?c=d HTTP/1.1\r\nHost: x\r\nX-Thing:  one \r\nx-thing:two\r\nContent-Length: 12\r\n"
      "Expect: 100-Continue\r\n\r\nthe body";
  for (std::size_t at_once = 1; at_once <= bytes.size(); ++at_once) {
    std::string rest;
    const Head head = parse(bytes, at_once, &rest);
    EXPECT_EQ(rest, "the body") << at_once;
    EXPECT_EQ(head.method, "POST");
    EXPECT_EQ(head.target, "/a%20b?c=d");
    EXPECT_FALSE(head.http_1_0);
    EXPECT_TRUE(head.keep_alive);
    EXPECT_TRUE(head.expects_continue);
    EXPECT_EQ(head.framing, Framing::kLength);
    EXPECT_EQ(head.content_length, 12u);
    EXPECT_THAT(head.fields, ElementsAre(Pair("host", "x"), Pair("x-thing", "one"), Pair("x-thing", "two"),
                                         Pair("content-length", "12"), Pair("expect", "100-Continue")));
    EXPECT_EQ(head.field("x-thing"), "one, two");
    EXPECT_EQ(head.field("nothing"), "");
  }
}

TEST(HeadParser, KnowsWhetherTheConnectionGoesOn) {
  EXPECT_FALSE(parse("GET / HTTP/1.1\r\nHost: x\r\nConnection: TE, Close\r\n\r\n", 99).keep_alive);
  EXPECT_FALSE(parse("GET / HTTP/1.0\r\n\r\n", 99).keep_alive);
  EXPECT_TRUE(parse("GET / HTTP/1.0\r\nConnection: keep-alive\r\n\r\n", 99).keep_alive);
}

TEST(HeadParser, HasLimits) {
  const std::string line = "GET / HTTP/1.1\r\nHost: x\r\nX: ";
  EXPECT_EQ(code_of(line + std::string(kMaxBytes - line.size() - 4, 'x') + "\r\n\r\n"), "whole");
  EXPECT_EQ(code_of(line + std::string(kMaxBytes - line.size() - 3, 'x') + "\r\n\r\n"), "headers_too_large");
  EXPECT_EQ(code_of(std::string(kMaxBytes, 'x')), "not whole");
  EXPECT_EQ(code_of(std::string(kMaxBytes + 1, 'x')), "headers_too_large");
  EXPECT_EQ(code_of("GET /" + std::string(kMaxTarget - 1, 'x') + " HTTP/1.1\r\nHost: x\r\n\r\n"), "whole");
  EXPECT_EQ(code_of("GET /" + std::string(kMaxTarget, 'x') + " HTTP/1.1\r\nHost: x\r\n\r\n"), "uri_too_long");
}

TEST(HeadParser, RefusesWhatTwoReadersCouldReadTwoWays) {
  for (const char* fields : {
           "Host: x\r\nHost: y\r\n",
           "X: y\r\n",
           "Host: x\r\nContent-Type: a\r\nContent-Type: b\r\n",
           "Host: x\r\nAuthorization: a\r\nAuthorization: b\r\n",
           "Host: x\r\nX : y\r\n",
           "Host: x\r\nX: a\nY: b\r\n",
           "Host: x\r\nX: a\rb\r\n",
           "Host: x\r\n\tfolded\r\n",
           "Host: x\r\nContent-Length: 1, 1\r\n",
           "Host: x\r\nContent-Length:\r\n",
           "Host: x\r\nContent-Length: 0x1\r\n",
           "Host: x\r\nTransfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n",
           "Host: x\r\nTransfer-Encoding: chunked, identity\r\n",
       }) {
    EXPECT_EQ(code_of("GET / HTTP/1.1\r\n" + std::string(fields) + "\r\n"), "malformed_request") << fields;
  }
  EXPECT_EQ(code_of(std::string("GET /\0 HTTP/1.1\r\nHost: x\r\n\r\n", 29)), "malformed_request");
}

}  // namespace
}  // namespace mapweld::server
