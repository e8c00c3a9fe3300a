// A request and a reply as handlers see them: no socket, no library type, so that every handler can be called from a
// test.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/access/caller.h"
#include "server/http/event_stream.h"
#include "server/http/files/body_file.h"

namespace mapweld::server {

// The query of a request, with typed readers. Each reader throws ContractError invalid_parameter, naming the parameter,
// when the value does not fit or the parameter is given twice.
class Query {
 public:
  Query() = default;
  explicit Query(std::multimap<std::string, std::string> values) : values_(std::move(values)) {}

  std::optional<std::string> text(const std::string& name) const;
  // A whole decimal number in [min, max].
  std::optional<std::int64_t> integer(const std::string& name, std::int64_t min, std::int64_t max) const;
  std::optional<bool> boolean(const std::string& name) const;  // true, false, 1, 0

  const std::multimap<std::string, std::string>& values() const { return values_; }

  // Throws ContractError unknown_field for a parameter that is not among `known`.
  void refuse_unknown(std::span<const std::string> known) const;

 private:
  std::multimap<std::string, std::string> values_;
};

struct Request {
  std::string method;
  std::string path;                               // as sent, percent-encoded
  std::map<std::string, std::string> parameters;  // of the path pattern, decoded
  Query query;
  std::string content_type;   // as sent, with its parameters; empty when absent
  std::string last_event_id;  // as sent; empty when absent
  std::string if_none_match;  // as sent; empty when absent
  bool accepts_gzip = false;
  std::string range;     // as sent; empty when absent
  std::string if_range;  // as sent; empty when absent
  std::optional<std::string> idempotency_key;  // as sent, the values of several joined by ", "
  std::string body;
  std::shared_ptr<BodyFile> body_file;  // instead of `body`, where the route wants that
  std::string request_id;
  std::shared_ptr<const Caller> caller;  // null: everything may be used

  // The client has the answer with this ETag: one that has nothing but the ETag is enough.
  bool knows(const std::string& etag) const;
  // A parameter of the path pattern. Throws std::out_of_range when the route has none of that name.
  const std::string& parameter(const std::string& name) const { return parameters.at(name); }
  std::span<const std::uint8_t> body_bytes() const {
    return {reinterpret_cast<const std::uint8_t*>(body.data()), body.size()};
  }
};

// Appends the next piece of a streamed body, some tens of kB. False: it was the last.
using NextPiece = std::function<bool(std::string& piece)>;

struct Reply {
  int status = 200;
  std::string content_type;
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
  // What stands for the body, quoted (RFC 9110, section 8.8.3); empty: nothing. Sent with it, and in place of it, as a
  // 304, to a client that has it.
  std::string etag;
  std::string subject;  // what was changed, where the path does not say: for the log, never sent
  // When set, the body is streamed instead (chunked): called by any thread, after the handler has returned, and again
  // when the client has taken the last piece, so that one who reads slowly holds a piece and no thread. An exception in
  // it breaks the connection off, so that the client cannot take a part for the whole.
  NextPiece stream;
  std::optional<std::uint64_t> stream_bytes;  // how many they will be, where that is known: no chunks then
  // When set, the body is what comes from here, until it ends or the client goes; a comment (": ") every
  // event_heartbeat_ms. Holds no thread.
  std::shared_ptr<EventStream> events;
};

using Handler = std::function<Reply(const Request&)>;

}  // namespace mapweld::server
