#include "server/http/loop/transport.h"

#include <cerrno>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

namespace mapweld::server {
namespace {

using Then = Transport::Moved::Then;

Transport::Moved of_socket(ssize_t result, Then blocked) {
  if (result > 0) return {.bytes = static_cast<std::size_t>(result)};
  const bool again = result < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  return {.then = again ? blocked : Then::kOver};
}

}  // namespace

Transport::Transport(Socket socket, const TlsCredentials* tls) : socket_(std::move(socket)) {
  boost::system::error_code ignored;
  socket_.native_non_blocking(true, ignored);
  socket_.set_option(boost::asio::ip::tcp::no_delay(true), ignored);
  if (tls) tls_ = tls->session(socket_.native_handle());
}

Transport::Moved Transport::of_tls(int result) {
  if (result > 0) return {.bytes = static_cast<std::size_t>(result)};
  switch (SSL_get_error(tls_.get(), result)) {
    case SSL_ERROR_WANT_READ:
      return {.then = Then::kReadable};
    case SSL_ERROR_WANT_WRITE:
      return {.then = Then::kWritable};
    default:
      return {.then = Then::kOver};
  }
}

Transport::Moved Transport::read(std::span<char> into) {
  if (!tls_) return of_socket(::recv(socket_.native_handle(), into.data(), into.size(), 0), Then::kReadable);
  ERR_clear_error();
  return of_tls(SSL_read(tls_.get(), into.data(), static_cast<int>(into.size())));
}

Transport::Moved Transport::write(std::string_view from) {
  if (!tls_) return of_socket(::send(socket_.native_handle(), from.data(), from.size(), MSG_NOSIGNAL), Then::kWritable);
  ERR_clear_error();
  return of_tls(SSL_write(tls_.get(), from.data(), static_cast<int>(from.size())));
}

Transport::Moved Transport::shake_hands() {
  if (!tls_) return {};
  ERR_clear_error();
  Moved moved = of_tls(SSL_accept(tls_.get()));
  moved.bytes = 0;
  return moved;
}

bool Transport::is_over() {
  char byte = 0;
  if (!tls_) {
    return of_socket(::recv(socket_.native_handle(), &byte, 1, MSG_PEEK), Then::kReadable).then == Then::kOver;
  }
  ERR_clear_error();
  return of_tls(SSL_peek(tls_.get(), &byte, 1)).then == Then::kOver;
}

void Transport::end() {
  if (tls_) {
    ERR_clear_error();
    SSL_shutdown(tls_.get());
  }
  boost::system::error_code ignored;
  socket_.shutdown(Socket::shutdown_send, ignored);
}

}  // namespace mapweld::server
