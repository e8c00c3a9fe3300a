// The head of a request, from bytes as they come. Knows no socket and no clock.
//
// It is checked as a whole before anybody acts on it (RFC 9112): bare line feeds, folded or nameless fields, control
// characters, contradicting or unknown framing and a missing or double Host are refused, not repaired.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mapweld::server {

// How the body of a request is framed (RFC 9112, section 6).
enum class Framing : std::uint8_t { kNone, kLength, kChunked };

struct Head {
  std::string method = {};
  std::string target = {};                                       // path and query, percent-encoded
  bool http_1_0 = false;                                         // else HTTP/1.1
  std::vector<std::pair<std::string, std::string>> fields = {};  // names in small letters, in the order sent
  Framing framing = Framing::kNone;
  std::uint64_t content_length = 0;
  bool keep_alive = true;
  bool expects_continue = false;

  // The values of a field joined by ", " (RFC 9110, section 5.2); empty when it was not sent. `name` in small letters.
  std::string field(std::string_view name) const;
  bool has(std::string_view name) const;  // it was sent, with a value or without
};

class HeadParser {
 public:
  HeadParser(std::size_t max_bytes, std::size_t max_target_bytes);

  // Takes from the front of `input` what belongs to the head. True: head() is complete. Time is linear in the bytes.
  // Throws ContractError headers_too_large, uri_too_long, malformed_request.
  bool take(std::string_view& input);

  Head& head() { return head_; }

 private:
  void parse();
  void parse_request_line(std::string_view line);
  void parse_field(std::string_view line);
  void finish();

  const std::size_t max_bytes_;
  const std::size_t max_target_bytes_;
  std::string text_;
  Head head_;
};

}  // namespace mapweld::server
