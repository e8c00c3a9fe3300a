// The body of a request, from bytes as they come. Knows no socket and no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/files/body_file.h"
#include "server/http/wire/body_budget.h"
#include "server/http/wire/head_parser.h"

namespace mapweld::server {

class BodyReader {
 public:
  // Of a request whose head is `head`; takes at most `max_bytes`, as far as `budget` has them, until it is destroyed.
  // Throws ContractError body_too_large when the head announces more. With a `file` the body goes there, and takes
  // nothing of the budget.
  BodyReader(const Head& head, std::uint64_t max_bytes, BodyBudget& budget, BodyFile* file = nullptr);

  // Takes from the front of `input` what belongs to the body. True: body() is complete. Time is linear in the bytes,
  // however small the chunks. Throws ContractError body_too_large, malformed_request (chunks), busy (budget), and what
  // the file throws.
  bool take(std::string_view& input);

  std::string& body() { return body_; }
  std::uint64_t bytes() const { return bytes_; }  // of the body, until now

 private:
  enum class Expect : std::uint8_t { kData, kSizeLine, kEndOfChunk, kTrailer, kNothing };

  bool take_line(std::string_view& input);
  void take_data(std::string_view& input);
  void begin_chunk();

  const std::uint64_t max_bytes_;
  const bool chunked_;
  BodyBudget::Share share_;
  BodyFile* const file_;
  Expect expect_;
  std::uint64_t left_ = 0;  // of the data that is expected
  std::string line_;        // the part of a line that has come
  int trailers_ = 0;
  std::uint64_t bytes_ = 0;
  std::string body_;
};

}  // namespace mapweld::server
