#include "server/http/wire/reply_head.h"

#include <array>
#include <charconv>

#include <boost/beast/http/status.hpp>

namespace mapweld::server {
namespace {

void add_field(std::string& head, std::string_view name, std::string_view value) {
  head.append(name).append(": ").append(value).append("\r\n");
}

bool has_no_length(const Reply& reply) { return (reply.stream && !reply.stream_bytes) || reply.events; }

}  // namespace

bool ends_by_closing(const Reply& reply, const ReplyFrame& frame) { return has_no_length(reply) && frame.http_1_0; }

std::string reply_head(const Reply& reply, const ReplyFrame& frame) {
  const auto status = boost::beast::http::int_to_status(static_cast<unsigned>(reply.status));
  const std::string_view reason(boost::beast::http::obsolete_reason(status).data(),
                                boost::beast::http::obsolete_reason(status).size());
  std::string head = "HTTP/1.1 " + std::to_string(reply.status) + " ";
  head.append(reason).append("\r\n");
  for (const auto& [name, value] : reply.headers) add_field(head, name, value);
  for (const auto& [name, value] : frame.headers) add_field(head, name, value);
  add_field(head, "X-Request-Id", frame.request_id);
  if (!reply.content_type.empty()) add_field(head, "Content-Type", reply.content_type);
  if (!has_no_length(reply)) {
    if (reply.status != 204 && reply.status != 304) {
      add_field(head, "Content-Length", std::to_string(reply.stream_bytes.value_or(reply.body.size())));
    }
  } else if (!frame.http_1_0) {
    add_field(head, "Transfer-Encoding", "chunked");
  }
  if (frame.close || ends_by_closing(reply, frame)) {
    add_field(head, "Connection", "close");
  } else if (frame.http_1_0) {
    add_field(head, "Connection", "keep-alive");
  }
  return head.append("\r\n");
}

std::string chunk(std::string_view piece) {
  if (piece.empty()) return "";
  std::array<char, 16> size{};
  const auto end = std::to_chars(size.data(), size.data() + size.size(), piece.size(), 16).ptr;
  std::string text(size.data(), end);
  return text.append("\r\n").append(piece).append("\r\n");
}

}  // namespace mapweld::server
