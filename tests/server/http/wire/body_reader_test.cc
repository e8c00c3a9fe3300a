#include "server/http/wire/body_reader.h"

#include <algorithm>
#include <ctime>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "client/contract/problem.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::size_t kMaxBytes = 1000;

Head length(std::uint64_t bytes) { return {.framing = Framing::kLength, .content_length = bytes}; }
Head chunked() { return {.framing = Framing::kChunked}; }

struct Read {
  std::string body;
  std::string rest;  // what follows
  std::string code;  // of what was thrown
  bool whole = false;
};

// `bytes` arrive `at_once` at a time.
Read read(const Head& head, std::string_view bytes, std::size_t at_once, std::size_t budget_bytes = 1 << 20) {
  BodyBudget budget(budget_bytes);
  Read read;
  try {
    BodyReader reader(head, kMaxBytes, budget);
    while (!read.whole && !bytes.empty()) {
      std::string_view piece = bytes.substr(0, at_once);
      bytes.remove_prefix(piece.size());
      read.whole = reader.take(piece);
      read.rest = std::string(piece) + std::string(bytes);
    }
    read.body = reader.body();
  } catch (const ContractError& error) {
    read.code = error.code().word();
  }
  BodyBudget::Share all(budget);
  EXPECT_TRUE(all.take(budget_bytes)) << "not all was given back";
  return read;
}

TEST(BodyReader, IsTheSameHoweverItArrives) {
  const std::string chunks = "5;ext=\"1\"\r\nhello\r\n1\r\n \r\n00A\r\nworld\r\n\r\n!\r\n0\r\nTrailer: x\r\n\r\nnext";
  for (std::size_t at_once = 1; at_once <= chunks.size(); ++at_once) {
    const Read in_chunks = read(chunked(), chunks, at_once);
    EXPECT_TRUE(in_chunks.whole);
    EXPECT_EQ(in_chunks.body, "hello world\r\n\r\n!");
    EXPECT_EQ(in_chunks.rest, "next");
    const Read by_length = read(length(5), "hellonext", at_once);
    EXPECT_TRUE(by_length.whole);
    EXPECT_EQ(by_length.body, "hello");
    EXPECT_EQ(by_length.rest, "next");
  }
  EXPECT_TRUE(read(length(0), "next", 1).whole);
  EXPECT_FALSE(read(length(5), "hell", 1).whole);
  EXPECT_FALSE(read(chunked(), "5\r\nhello\r\n0\r\n", 1).whole);
}

TEST(BodyReader, AnEmptyBodyIsWholeAtOnce) {
  BodyBudget budget(1);
  BodyReader reader(length(0), 10, budget);
  std::string_view nothing;
  EXPECT_TRUE(reader.take(nothing));
}

TEST(BodyReader, RefusesBrokenChunks) {
  for (const char* bytes : {"-1\r\n", "+1\r\n", "0x5\r\n", "\r\n", "g\r\n", ";x\r\n", "5\nhello\r\n", "5\r\nhelloX\r\n",
                            "5\r\nhello\n0\r\n", "10000000000000000\r\n", "0\r\na\rb\r\n\r\n"}) {
    for (const std::size_t at_once : {1, 100}) EXPECT_EQ(read(chunked(), bytes, at_once).code, "malformed_request");
  }
  EXPECT_EQ(read(chunked(), std::string(300, '0'), 1).code, "malformed_request");
  std::string trailers = "0\r\n";
  for (int i = 0; i < 33; ++i) trailers += "x: y\r\n";
  EXPECT_EQ(read(chunked(), trailers, 1).code, "malformed_request");
}

TEST(BodyReader, HasLimits) {
  EXPECT_EQ(read(length(kMaxBytes), "", 1).code, "");
  EXPECT_EQ(read(length(kMaxBytes + 1), "", 1).code, "body_too_large");
  EXPECT_EQ(read(chunked(), "3e8\r\n", 1).code, "");
  EXPECT_EQ(read(chunked(), "3e9\r\n", 1).code, "body_too_large");
  EXPECT_EQ(read(chunked(), "1\r\nx\r\n3e8\r\n", 1).code, "body_too_large");
  EXPECT_EQ(read(chunked(), "ffffffffffffffff\r\n", 1).code, "body_too_large");
  EXPECT_EQ(read(length(10), "0123456789", 4, 10).code, "");
  EXPECT_EQ(read(length(10), "0123456789", 4, 9).code, "busy");
}

// A body in chunks of one byte cost 0.12 s a MB when the rest was moved for each.
double processor_s() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// What a body of `count` bytes in chunks of one costs, at best.
double cost_of_small_chunks_s(int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += "1\r\nx\r\n";
  bytes += "0\r\n\r\n";
  double best_s = 1e9;
  for (int time = 0; time < 3; ++time) {
    BodyBudget budget(1 << 30);
    const double before_s = processor_s();
    BodyReader reader(chunked(), 1 << 20, budget);
    std::string_view input = bytes;
    EXPECT_TRUE(reader.take(input));
    EXPECT_EQ(reader.body().size(), static_cast<std::size_t>(count));
    best_s = std::min(best_s, processor_s() - before_s);
  }
  return best_s;
}

// Sixteen times as many; moving the rest of the input for each would make it 256 times as long.
TEST(BodyReader, ChunksOfOneByteCostNoMoreThanTheirBytes) {
  EXPECT_LT(cost_of_small_chunks_s(1 << 19), 64 * cost_of_small_chunks_s(1 << 15));
}

}  // namespace
}  // namespace mapweld::server
