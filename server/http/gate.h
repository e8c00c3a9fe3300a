// Who is let in: the one thing that the HTTP server asks about a request before it reads any of its body.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/access/caller.h"
#include "server/http/message.h"
#include "server/http/router.h"

namespace mapweld::server {

// What is known of a request when its head is read and its route is looked up. A field that was sent several times has
// its values joined by ", " (RFC 9110, section 5.2); one that was not sent is empty.
struct RequestHead {
  std::string request_id;
  std::string method;
  std::string path;                               // percent-encoded, without query
  const Route* route = nullptr;                   // null: none matched
  std::string allow;                              // for the Allow field, when none matched; may be empty
  std::map<std::string, std::string> parameters;  // of the route's pattern, decoded
  std::string authorization;
  std::string origin;
  std::string host;
  std::string content_type;
  std::string peer;  // the client's address, without port
};

struct Admission {
  // Set: this is the answer; no handler runs and the body is not read.
  std::optional<Reply> reply;
  // Who it is, for handlers and for the log; null: nobody was asked who they are.
  std::shared_ptr<const Caller> caller;
  // Added to whatever is answered.
  std::vector<std::pair<std::string, std::string>> headers;
};

// A request that is answered, to its last byte or as far as the client took it.
struct FinishedRequest {
  std::string request_id;
  std::string method;
  std::string path;            // as in RequestHead; empty: its head never was one
  std::string route;           // pattern; empty: none matched
  Role role = Role::kAnybody;  // that the route asks for
  std::string peer;
  std::string subject;                   // Reply::subject
  std::shared_ptr<const Caller> caller;  // of the admission; null: none
  int status = 0;
  std::uint64_t bytes_in = 0;   // of the body
  std::uint64_t bytes_out = 0;  // of the body
  double elapsed_s = 0;         // from the head's first byte to the reply's last
};

// Both are called by any thread that serves connections, several at once, and must return soon: they may look at memory
// and write a line, not wait for a disk or another request.
class Gate {
 public:
  virtual ~Gate() = default;
  // Of an exception the server makes the answer, as of a handler's.
  virtual Admission admit(const RequestHead& head) = 0;
  virtual void finished(const FinishedRequest& request) noexcept = 0;
};

}  // namespace mapweld::server
