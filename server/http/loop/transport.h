// The bytes of one connection, plain or by TLS, moved as far as they go at once: nothing here waits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>  // missing in <boost/asio/awaitable.hpp> of 1.74

#include <boost/asio/ip/tcp.hpp>

#include "server/http/loop/tls.h"

namespace mapweld::server {

// Used by one thread.
class Transport {
 public:
  using Socket = boost::asio::ip::tcp::socket;

  // `tls`: null for a plain connection. Whoever passes one has SIGPIPE ignored in the process.
  explicit Transport(Socket socket, const TlsCredentials* tls = nullptr);

  // What one call has moved. When it is nothing: what to wait for before the next call, unless the connection is over.
  struct Moved {
    enum class Then : std::uint8_t { kMore, kReadable, kWritable, kOver };
    std::size_t bytes = 0;
    Then then = Then::kMore;
  };
  Moved read(std::span<char> into);
  Moved write(std::string_view from);
  // kMore: done, reading and writing may begin. A plain connection has nothing to do.
  Moved shake_hands();

  // Whether the client has ended the connection, as far as can be told without reading what it sent.
  bool is_over();

  // Tells the client that nothing more comes.
  void end();

  Socket& socket() { return socket_; }

 private:
  Moved of_tls(int result);

  Socket socket_;
  TlsSession tls_;  // null: plain
};

}  // namespace mapweld::server
