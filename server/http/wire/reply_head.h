// How a reply is written: its status line and header fields, and the pieces of a body whose length nobody knows yet.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/http/message.h"

namespace mapweld::server {

// What the connection adds to a reply.
struct ReplyFrame {
  std::string request_id;
  std::vector<std::pair<std::string, std::string>> headers;  // of the gate
  bool http_1_0 = false;                                     // the client knows no chunks
  bool close = false;                                        // no request may follow
};

// Whether the body's end is the connection's end.
bool ends_by_closing(const Reply& reply, const ReplyFrame& frame);

// Ends with the empty line.
std::string reply_head(const Reply& reply, const ReplyFrame& frame);

// `piece` as one chunk (RFC 9112, section 7.1). An empty one would end the body: it gives nothing.
std::string chunk(std::string_view piece);
inline constexpr std::string_view kLastChunk = "0\r\n\r\n";

}  // namespace mapweld::server
