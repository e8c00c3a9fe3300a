// A certificate with its key, and the sessions that clients have under it: TLS 1.2 and up, by OpenSSL.
#pragma once

#include <memory>
#include <string>

#include <openssl/types.h>

namespace mapweld::server {

struct TlsDeleter {
  void operator()(SSL* session) const;
  void operator()(SSL_CTX* context) const;
};
using TlsSession = std::unique_ptr<SSL, TlsDeleter>;

// Immutable. Sessions outlive it.
class TlsCredentials {
 public:
  // `certificate`: PEM, the server's own first and then those that vouch for it. `key`: PEM.
  // Throws std::runtime_error, saying which file is wrong and how.
  TlsCredentials(const std::string& certificate, const std::string& key);

  // A server's session over a connected socket that does not block. Idle ones keep no buffers. Throws std::bad_alloc.
  TlsSession session(int socket) const;

 private:
  std::unique_ptr<SSL_CTX, TlsDeleter> context_;
};

}  // namespace mapweld::server
