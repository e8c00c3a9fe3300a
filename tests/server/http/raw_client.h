// A client that sends exactly the bytes it is told to, as strangers do.
#pragma once

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace mapweld::test {

class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) {
      throw std::runtime_error("cannot connect");
    }
  }
  ~RawClient() { ::close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  // False when the server has closed.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  // The next reply: head and, by its Content-Length, body. Empty when the server closes or says nothing for 20 s.
  std::string receive() {
    std::string reply = std::move(ahead_);
    ahead_.clear();
    while (true) {
      const std::size_t head = reply.find("\r\n\r\n");
      if (head != std::string::npos) {
        const std::size_t at = reply.find("Content-Length: ");
        const std::size_t length = at < head ? std::stoul(reply.substr(at + 16)) : 0;
        if (reply.size() >= head + 4 + length) {
          ahead_ = reply.substr(head + 4 + length);
          return reply.substr(0, head + 4 + length);
        }
      }
      if (!more(reply)) return reply;
    }
  }

  // What arrives next, or has; "timeout" when nothing does for 20 s or the server has closed.
  std::string receive_some() {
    std::string some = std::move(ahead_);
    ahead_.clear();
    if (some.empty() && !more(some)) return "timeout";
    return some;
  }

  // Whether the server closes within `seconds`.
  bool closed_within(double seconds) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    std::string rest;
    while (std::chrono::steady_clock::now() < deadline) {
      pollfd fd{socket_, POLLIN, 0};
      rest.clear();
      if (::poll(&fd, 1, 50) > 0 && !more(rest)) return true;
    }
    return false;
  }

 private:
  bool more(std::string& into) const {
    pollfd fd{socket_, POLLIN, 0};
    if (::poll(&fd, 1, 20'000) <= 0) return false;
    char buffer[4096];
    const ssize_t got = ::recv(socket_, buffer, sizeof(buffer), 0);
    if (got <= 0) return false;
    into.append(buffer, static_cast<std::size_t>(got));
    return true;
  }

  int socket_;
  std::string ahead_;
};

}  // namespace mapweld::test
