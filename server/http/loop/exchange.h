// A request and its reply, on their way through a connection.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/contract/problem.h"
#include "server/http/loop/connection.h"
#include "server/http/problem.h"
#include "server/http/wire/body_reader.h"

namespace mapweld::server {

struct Connection::Exchange {
  std::string request_id;  // in replies to what never became a plan
  Head head = {};
  Plan plan = {};
  std::optional<BodyReader> body = {};
  std::optional<Reply> reply = {};
  bool whole = false;  // the request was read to its end: another can follow
  bool close = false;  // none may
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  Stopwatch watch = {};

  const std::string& id() const { return plan.head.request_id.empty() ? request_id : plan.head.request_id; }
};

inline Reply reply_of(contract::Code code, const std::string& detail, const std::string& request_id) {
  return problem_reply(contract::problem_of(code, detail, request_id));
}

}  // namespace mapweld::server
