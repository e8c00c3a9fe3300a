#include "server/http/connection.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>

#include <poll.h>
#include <sys/socket.h>

namespace mapweld::server {
namespace {

constexpr std::size_t kReceiveBytes = 64 * 1024;
constexpr std::size_t kMaxChunkLine = 256;  // a chunk's size with its extensions
constexpr std::size_t kMaxTrailerLines = 32;
constexpr int kPollSliceMs = 50;

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// RFC 9110, section 5.6.2.
bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || std::string_view("!#$%&'*+-.^_`|~").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) { return (c < 0x20 && c != '\t') || c == 0x7f; });
}

bool parse_whole(std::string_view text, std::uint64_t& number, int base) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty();
}

}  // namespace

Connection::Connection(socket_t socket, const ConnectionLimits& limits, const std::atomic<bool>& draining)
    : socket_(socket), limits_(limits), draining_(draining) {}

bool Connection::wait(short events, int timeout_ms) const {
  pollfd fd{socket_, events, 0};
  int ready = 0;
  do {
    ready = ::poll(&fd, 1, timeout_ms);
  } while (ready < 0 && errno == EINTR);
  return ready > 0;
}

bool Connection::wait_for_request(const std::function<bool()>& give_up) {
  if (!buffer_.empty()) return true;
  const auto deadline = Clock::now() + std::chrono::milliseconds(limits_.idle_timeout_ms);
  while (!wait(POLLIN, draining_ ? 0 : kPollSliceMs)) {
    if (draining_ || Clock::now() >= deadline || give_up()) return false;
  }
  char first = 0;
  return ::recv(socket_, &first, 1, MSG_PEEK) > 0;
}

Connection::Fill Connection::fill(Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0 || !wait(POLLIN, static_cast<int>(left))) return Fill::kTimeout;
    const std::size_t had = buffer_.size();
    buffer_.resize(had + kReceiveBytes);
    const ssize_t got = ::recv(socket_, buffer_.data() + had, kReceiveBytes, 0);
    buffer_.resize(had + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got > 0) return Fill::kData;
    if (got == 0) return Fill::kClosed;
    if (errno != EINTR && errno != EAGAIN) return Fill::kClosed;
  }
}

Connection::Head Connection::read_head() {
  head_.clear();
  head_position_ = 0;
  framing_ = Framing::kNone;
  content_length_ = 0;
  content_encoding_.clear();
  content_type_.clear();
  expects_continue_ = false;
  body_consumed_ = false;

  const auto deadline = Clock::now() + std::chrono::milliseconds(limits_.head_timeout_ms);
  std::size_t searched = 0;
  while (true) {
    // Empty lines before a request are ignored (RFC 9112, section 2.2).
    while (buffer_.starts_with("\r\n")) buffer_.erase(0, 2);
    const std::size_t end = buffer_.find("\r\n\r\n", searched);
    if (end != std::string::npos && end + 4 <= limits_.max_head_bytes) {
      const std::string head = buffer_.substr(0, end + 2);
      buffer_.erase(0, end + 4);
      const Head outcome = check_head(head);
      body_consumed_ = outcome == Head::kComplete && framing_ == Framing::kNone;
      return outcome;
    }
    if (end != std::string::npos || buffer_.size() > limits_.max_head_bytes) return Head::kTooLarge;
    searched = buffer_.size() < 3 ? 0 : buffer_.size() - 3;
    switch (fill(deadline)) {
      case Fill::kData:
        break;
      case Fill::kClosed:
        return Head::kClosed;
      case Fill::kTimeout:
        return Head::kTimeout;
    }
  }
}

// `head`: lines, each with its CRLF.
Connection::Head Connection::check_head(std::string_view head) {
  bool request_line = true;
  while (!head.empty()) {
    const std::size_t end = head.find("\r\n");
    const std::string_view line = head.substr(0, end);
    head.remove_prefix(end + 2);
    if (has_control(line)) return Head::kMalformed;  // bare CR and LF among them
    bool pass_on = true;
    if (!request_line) {
      if (const Head outcome = take_field(line, pass_on); outcome != Head::kComplete) return outcome;
    }
    request_line = false;
    if (pass_on) head_.append(line).append("\r\n");
  }
  head_.append("\r\n");
  return Head::kComplete;
}

Connection::Head Connection::take_field(std::string_view line, bool& pass_on) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) return Head::kMalformed;
  const std::string name = lower(line.substr(0, colon));
  const std::string_view value = trim(line.substr(colon + 1));
  pass_on = false;
  if (name == "content-length") {
    std::uint64_t length = 0;
    if (framing_ != Framing::kNone || !parse_whole(value, length, 10)) return Head::kMalformed;
    framing_ = Framing::kLength;
    content_length_ = length;
  } else if (name == "transfer-encoding") {
    if (framing_ != Framing::kNone || lower(value) != "chunked") return Head::kMalformed;
    framing_ = Framing::kChunked;
  } else if (name == "content-encoding") {
    content_encoding_ = lower(value) == "identity" ? "" : lower(value);
  } else if (name == "content-type") {
    content_type_ = value;
  } else if (name == "expect") {
    expects_continue_ = lower(value) == "100-continue";
  } else if (name != "range" && name != "if-range" && name != "accept-encoding") {
    pass_on = true;
  }
  return Head::kComplete;
}

Connection::Body Connection::read_body(std::size_t max_bytes, std::string& body,
                                       const std::function<bool(std::size_t)>& reserve) {
  body.clear();
  if (framing_ == Framing::kNone) return Body::kComplete;
  if (framing_ == Framing::kLength && content_length_ > max_bytes) return Body::kTooLarge;
  if (expects_continue_ && !write_all("HTTP/1.1 100 Continue\r\n\r\n")) return Body::kClosed;
  expects_continue_ = false;
  const auto deadline = Clock::now() + std::chrono::milliseconds(limits_.body_timeout_ms);
  const Body outcome = framing_ == Framing::kLength ? read_bytes(content_length_, body, deadline, reserve)
                                                    : read_chunks(max_bytes, body, deadline, reserve);
  body_consumed_ = outcome == Body::kComplete;
  return outcome;
}

Connection::Body Connection::read_bytes(std::uint64_t count, std::string& body, Clock::time_point deadline,
                                        const std::function<bool(std::size_t)>& reserve) {
  while (count > 0) {
    if (buffer_.empty()) {
      const auto idle = Clock::now() + std::chrono::milliseconds(limits_.body_idle_timeout_ms);
      const Fill filled = fill(std::min(deadline, idle));
      if (filled != Fill::kData) return filled == Fill::kTimeout ? Body::kTimeout : Body::kClosed;
    }
    const auto take = static_cast<std::size_t>(std::min<std::uint64_t>(count, buffer_.size()));
    if (!reserve(take)) return Body::kBusy;
    body.append(buffer_, 0, take);
    buffer_.erase(0, take);
    count -= take;
  }
  return Body::kComplete;
}

Connection::Body Connection::read_line(std::string& line, Clock::time_point deadline) {
  while (true) {
    const std::size_t end = buffer_.find("\r\n");
    if (end != std::string::npos && end <= kMaxChunkLine) {
      line = buffer_.substr(0, end);
      buffer_.erase(0, end + 2);
      return Body::kComplete;
    }
    if (buffer_.size() > kMaxChunkLine) return Body::kMalformed;
    const auto idle = Clock::now() + std::chrono::milliseconds(limits_.body_idle_timeout_ms);
    const Fill filled = fill(std::min(deadline, idle));
    if (filled != Fill::kData) return filled == Fill::kTimeout ? Body::kTimeout : Body::kClosed;
  }
}

// RFC 9112, section 7.1.
Connection::Body Connection::read_chunks(std::size_t max_bytes, std::string& body, Clock::time_point deadline,
                                         const std::function<bool(std::size_t)>& reserve) {
  std::string line;
  while (true) {
    if (const Body outcome = read_line(line, deadline); outcome != Body::kComplete) return outcome;
    std::uint64_t size = 0;
    if (!parse_whole(trim(std::string_view(line).substr(0, line.find(';'))), size, 16)) return Body::kMalformed;
    if (size == 0) break;
    if (size > max_bytes - body.size()) return Body::kTooLarge;
    if (const Body outcome = read_bytes(size, body, deadline, reserve); outcome != Body::kComplete) return outcome;
    if (const Body outcome = read_line(line, deadline); outcome != Body::kComplete) return outcome;
    if (!line.empty()) return Body::kMalformed;
  }
  for (std::size_t trailers = 0; trailers <= kMaxTrailerLines; ++trailers) {
    if (const Body outcome = read_line(line, deadline); outcome != Body::kComplete) return outcome;
    if (line.empty()) return Body::kComplete;
  }
  return Body::kMalformed;
}

void Connection::linger() {
  ::shutdown(socket_, SHUT_WR);
  const auto deadline = Clock::now() + std::chrono::milliseconds(limits_.linger_ms);
  do {
    buffer_.clear();
  } while (fill(deadline) == Fill::kData);
  buffer_.clear();
}

bool Connection::write_all(std::string_view data) {
  while (!data.empty()) {
    const ssize_t sent = write(data.data(), data.size());
    if (sent < 0) return false;
    data.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

bool Connection::is_readable() const { return head_position_ < head_.size(); }

bool Connection::is_writable() const { return wait(POLLOUT, 0); }

ssize_t Connection::read(char* data, size_t size) {
  const std::size_t take = std::min(size, head_.size() - head_position_);
  std::copy_n(head_.data() + head_position_, take, data);
  head_position_ += take;
  return static_cast<ssize_t>(take);
}

ssize_t Connection::write(const char* data, size_t size) {
  while (true) {
    const ssize_t sent = ::send(socket_, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) return sent;
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return -1;
    if (!wait(POLLOUT, limits_.write_timeout_ms)) return -1;
  }
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t length = sizeof(address);
  ip.clear();
  port = 0;
  if (::getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &length) != 0) return;
  char host[NI_MAXHOST];
  char service[NI_MAXSERV];
  if (::getnameinfo(reinterpret_cast<sockaddr*>(&address), length, host, sizeof(host), service, sizeof(service),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return;
  }
  ip = host;
  port = std::atoi(service);
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

}  // namespace mapweld::server
