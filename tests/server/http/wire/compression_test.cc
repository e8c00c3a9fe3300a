#include "server/http/wire/compression.h"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

namespace mapweld::server {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Pair;

// By zlib's other half; throws unless it is one whole gzip file.
std::string inflated(const std::string& gzip) {
  z_stream stream{};
  inflateInit2(&stream, MAX_WBITS + 16);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  std::string text;
  int result = Z_OK;
  while (result == Z_OK) {
    char piece[1000];
    stream.next_out = reinterpret_cast<Bytef*>(piece);
    stream.avail_out = sizeof piece;
    result = inflate(&stream, Z_NO_FLUSH);
    text.append(piece, sizeof piece - stream.avail_out);
  }
  const bool whole = result == Z_STREAM_END && stream.avail_in == 0;
  inflateEnd(&stream);
  if (!whole) throw std::runtime_error("no whole gzip file");
  return text;
}

std::string some_text(std::size_t lines) {
  std::string text;
  for (std::size_t i = 0; i < lines; ++i) text += "{\"u\":" + std::to_string(i * 7919 % 1009) + "},\n";
  return text;
}

TEST(Compression, IsAskedFor) {
  for (const char* line : {"gzip", "GZip", "x-gzip", "br, gzip", "gzip;q=0.001", "gzip;q=1.0", "*", "br;q=1, *;q=0.1",
                           "deflate,gzip ; q=0.5", "identity;q=0.5, gzip;q=0.5", "gzip;q=1.000, identity;q=0"}) {
    EXPECT_TRUE(accepts_gzip(line)) << line;
  }
  for (const char* line : {"", "identity", "br", "gzip;q=0", "gzip; q=0.000", "*, gzip;q=0",
                           "gzip;q=0.4, identity;q=0.5", "gzip;q=x", "gzipped", "*;q=0", ",", ";q=1"}) {
    EXPECT_FALSE(accepts_gzip(line)) << line;
  }
}

TEST(Compression, IsForText) {
  for (const char* type : {"application/json", "application/problem+json", "application/graphml+xml", "text/csv",
                           "text/vnd.graphviz", "Text/Plain; charset=utf-8"}) {
    EXPECT_TRUE(is_compressible(type)) << type;
  }
  for (const char* type : {"image/jpeg", "image/png", "text/event-stream", "text/event-stream; x=1", ""}) {
    EXPECT_FALSE(is_compressible(type)) << type;
  }
}

TEST(Compression, OfABodyIsTheBody) {
  Reply reply;
  reply.etag = "\"a\"";
  reply.body = some_text(100'000);
  const std::string text = reply.body;
  compress(reply);
  EXPECT_LT(reply.body.size(), text.size() / 3);
  EXPECT_EQ(inflated(reply.body), text);
  EXPECT_THAT(reply.headers, Contains(Pair("Content-Encoding", "gzip")));
  EXPECT_EQ(reply.etag, "W/\"a\"");  // of these bytes it is not
}

TEST(Compression, OfALittleIsNotWorthIt) {
  Reply reply;
  reply.etag = "\"a\"";
  reply.body = std::string(1023, 'x');
  compress(reply);
  EXPECT_EQ(reply.body, std::string(1023, 'x'));
  EXPECT_THAT(reply.headers, IsEmpty());
  EXPECT_EQ(reply.etag, "\"a\"");
}

TEST(Compression, OfAStreamIsTheStream) {
  for (const std::size_t piece_bytes : {1, 1000, 100'000, 10'000'000}) {
    const std::string text = some_text(piece_bytes == 1 ? 100 : 50'000);
    Reply reply;
    reply.stream = [&, at = std::size_t{0}](std::string& piece) mutable {
      piece += text.substr(at, piece_bytes);
      at += piece_bytes;
      return at < text.size();
    };
    compress(reply);
    std::string gzip;
    bool more = true;
    while (more) {
      std::string piece;
      more = reply.stream(piece);
      gzip += piece;
    }
    EXPECT_EQ(inflated(gzip), text);
  }
}

TEST(Compression, OfAStreamThatIsEmptyOrFails) {
  Reply reply;
  reply.stream = [](std::string&) { return false; };
  compress(reply);
  std::string piece;
  EXPECT_FALSE(reply.stream(piece));
  EXPECT_EQ(inflated(piece), "");
  reply.stream = [](std::string&) -> bool { throw std::runtime_error("the disk went away"); };
  compress(reply);
  EXPECT_THROW(reply.stream(piece), std::runtime_error);
}

}  // namespace
}  // namespace mapweld::server
