// The problem document of RFC 9457: what an error looks like on the wire.
#pragma once

#include <string>
#include <utility>

#include "client/contract/codec.h"
#include "client/contract/problem.h"

namespace mapweld::contract {

// application/problem+json.
struct Problem {
  std::string type;   // "urn:mapweld:problem:<code>"
  std::string title;  // the code's, the same for every occurrence
  int status = 0;
  std::string detail;      // for people; this occurrence
  std::string code;        // a stable word, for programs
  std::string request_id;  // names the request in the server's log
  static constexpr auto fields() {
    return std::tuple(field("type", &Problem::type), field("title", &Problem::title), field("status", &Problem::status),
                      field("detail", &Problem::detail), field("code", &Problem::code),
                      field("request_id", &Problem::request_id));
  }
  friend bool operator==(const Problem&, const Problem&) = default;
};

// The document for one occurrence of a code.
inline Problem problem_of(Code code, std::string detail, std::string request_id) {
  return {.type = "urn:mapweld:problem:" + std::string(code.word()),
          .title = std::string(code.title()),
          .status = code.status(),
          .detail = std::move(detail),
          .code = std::string(code.word()),
          .request_id = std::move(request_id)};
}

}  // namespace mapweld::contract
