// The body of a request, from bytes as they come. Knows no socket and no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/wire/body_budget.h"
#include "server/http/wire/head_parser.h"

namespace mapweld::server {

class BodyReader {
 public:
  // Of a request whose head is `head`; takes at most `max_bytes`, as far as `budget` has them, until it is destroyed.
  // Throws ContractError body_too_large when the head announces more.
  BodyReader(const Head& head, std::size_t max_bytes, BodyBudget& budget);

  // Takes from the front of `input` what belongs to the body. True: body() is complete. Time is linear in the bytes,
  // however small the chunks. Throws ContractError body_too_large, malformed_request (chunks), busy (budget).
  bool take(std::string_view& input);

  std::string& body() { return body_; }

 private:
  enum class Expect : std::uint8_t { kData, kSizeLine, kEndOfChunk, kTrailer, kNothing };

  bool take_line(std::string_view& input);
  void take_data(std::string_view& input);
  void begin_chunk();

  const std::size_t max_bytes_;
  const bool chunked_;
  BodyBudget::Share share_;
  Expect expect_;
  std::uint64_t left_ = 0;  // of the data that is expected
  std::string line_;        // the part of a line that has come
  int trailers_ = 0;
  std::string body_;
};

}  // namespace mapweld::server
