#include "server/http/wire/head_parser.h"

#include <algorithm>
#include <array>

#include "client/contract/problem.h"
#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::array<std::string_view, 9> kMethods = {"GET",   "HEAD",    "POST",    "PUT",  "DELETE",
                                                      "PATCH", "OPTIONS", "CONNECT", "TRACE"};
// Two of them could be told apart by one reader and not by the next.
constexpr std::array<std::string_view, 5> kOnlyOnce = {"host", "content-length", "transfer-encoding", "content-type",
                                                       "authorization"};

[[noreturn]] void refuse(const char* what) {
  throw ContractError("malformed_request", std::string("The request is not well-formed HTTP/1.1: ") + what + ".");
}

// RFC 9110, section 5.6.2.
bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return is_alphanumeric(c) || std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  });
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) { return (c < 0x20 && c != '\t') || c == 0x7f; });
}

bool has_field(const Head& head, std::string_view name) {
  return std::any_of(head.fields.begin(), head.fields.end(), [&](const auto& field) { return field.first == name; });
}

// Whether a list of words ("close, upgrade") has the word.
bool lists(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    if (trim(list.substr(0, end)) == word) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

}  // namespace

std::string Head::field(std::string_view name) const {
  std::string joined;
  bool first = true;
  for (const auto& [field, value] : fields) {
    if (field != name) continue;
    joined += (first ? "" : ", ") + value;
    first = false;
  }
  return joined;
}

bool Head::has(std::string_view name) const {
  return std::ranges::any_of(fields, [&](const auto& field) { return field.first == name; });
}

HeadParser::HeadParser(std::size_t max_bytes, std::size_t max_target_bytes)
    : max_bytes_(max_bytes), max_target_bytes_(max_target_bytes) {}

bool HeadParser::take(std::string_view& input) {
  // Empty lines before a request are ignored (RFC 9112, section 2.2).
  if (text_ == "\r" && input.starts_with('\n')) {
    text_.clear();
    input.remove_prefix(1);
  }
  while (text_.empty() && input.starts_with("\r\n")) input.remove_prefix(2);

  const std::size_t had = text_.size();
  text_.append(input.substr(0, max_bytes_ + 1 - had));
  const std::size_t end = text_.find("\r\n\r\n", had < 3 ? 0 : had - 3);
  if (end == std::string::npos) {
    if (text_.size() > max_bytes_) {
      throw ContractError("headers_too_large", "The request line and header fields are too long.");
    }
    input.remove_prefix(text_.size() - had);
    return false;
  }
  if (end + 4 > max_bytes_) {
    throw ContractError("headers_too_large", "The request line and header fields are too long.");
  }
  input.remove_prefix(end + 4 - had);
  text_.resize(end + 2);
  parse();
  text_ = std::string();
  return true;
}

void HeadParser::parse() {
  std::string_view rest = text_;
  bool request_line = true;
  while (!rest.empty()) {
    const std::size_t end = rest.find("\r\n");
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + 2);
    if (has_control(line)) refuse("a line has control characters");  // bare CR and LF among them
    request_line ? parse_request_line(line) : parse_field(line);
    request_line = false;
  }
  finish();
}

void HeadParser::parse_request_line(std::string_view line) {
  const std::size_t method = line.find(' ');
  const std::size_t target = line.rfind(' ');
  if (method == std::string_view::npos || target == method) refuse("the request line has not three parts");
  head_.method = line.substr(0, method);
  head_.target = line.substr(method + 1, target - method - 1);
  const std::string_view version = line.substr(target + 1);
  if (std::find(kMethods.begin(), kMethods.end(), head_.method) == kMethods.end()) refuse("the method is unknown");
  if (head_.target.size() > max_target_bytes_) {
    throw ContractError("uri_too_long", "The path and query are too long.");
  }
  if (head_.target.empty() || head_.target.find_first_of(" \t") != std::string::npos) refuse("the path has spaces");
  if (version != "HTTP/1.1" && version != "HTTP/1.0") refuse("the version is neither HTTP/1.1 nor HTTP/1.0");
  head_.http_1_0 = version == "HTTP/1.0";
  head_.keep_alive = !head_.http_1_0;
}

void HeadParser::parse_field(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) refuse("a line is no header field");
  const std::string name = lower(line.substr(0, colon));
  const std::string value(trim(line.substr(colon + 1)));
  if (std::find(kOnlyOnce.begin(), kOnlyOnce.end(), name) != kOnlyOnce.end() && has_field(head_, name)) {
    refuse("a field came twice that may come once");
  }
  if (name == "content-length" || name == "transfer-encoding") {
    if (head_.framing != Framing::kNone) refuse("the length of the body is said twice");
    if (name == "content-length") {
      if (!parse_whole(value, head_.content_length, 10)) refuse("Content-Length is no whole number");
      head_.framing = Framing::kLength;
    } else {
      if (lower(value) != "chunked") refuse("the only Transfer-Encoding is chunked");
      head_.framing = Framing::kChunked;
    }
  } else if (name == "expect") {
    head_.expects_continue = lower(value) == "100-continue";
  }
  head_.fields.emplace_back(name, value);
}

void HeadParser::finish() {
  if (!head_.http_1_0 && !has_field(head_, "host")) refuse("Host is missing");
  const std::string connection = lower(head_.field("connection"));
  if (lists(connection, "close")) head_.keep_alive = false;
  if (head_.http_1_0 && lists(connection, "keep-alive")) head_.keep_alive = true;
}

}  // namespace mapweld::server
