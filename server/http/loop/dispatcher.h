// What is decided about a request once its head is there and before any of its body is read: who answers it, or that it
// is refused. Knows no socket.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "server/http/gate.h"
#include "server/http/http_options.h"
#include "server/http/message.h"
#include "server/http/router.h"
#include "server/http/wire/head_parser.h"
#include "server/http/wire/host_names.h"

namespace mapweld::server {

// A request as far as its head says.
struct Plan {
  RequestHead head;              // for the log; complete as far as it came
  Request request;               // without body
  Admission admission;           // its reply is in `refusal`
  std::optional<Reply> refusal;  // set: no handler runs; of OPTIONS, too, which no handler answers
  bool takes_body = false;       // the handler wants the body, and there is one
  std::uint64_t max_body_bytes = 0;
};

class Dispatcher {
 public:
  // `gate`: null lets everybody in. It must outlive this.
  Dispatcher(const HttpOptions& options, Router router, Gate* gate);

  // `request_id`: unless the client sent a fit one of its own. What is thrown on the way becomes the refusal.
  Plan plan(const Head& head, const std::string& request_id, const std::string& peer) const;

  // Runs the handler of a plan that has its body. What is thrown becomes the reply. Any thread.
  static Reply answer(const Plan& plan);

 private:
  void consider(const Head& head, Plan& plan) const;
  void consider_body(const Head& head, Plan& plan) const;

  const HostNames hosts_;
  const std::size_t max_body_bytes_;
  const std::size_t max_json_bytes_;
  const std::uint64_t max_file_bytes_;
  const Router router_;
  Gate* const gate_;
};

}  // namespace mapweld::server
