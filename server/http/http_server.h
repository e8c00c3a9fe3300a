// The HTTP/1.1 server: one event loop for all connections, limits and request ids around the router. Knows no use case.
//
// The loop's thread accepts, reads heads and bodies and writes replies; it never waits for a client. Complete requests
// are handed to a pool of threads. A connection that is idle or slow costs a descriptor and some kilobytes.
#pragma once

#include <memory>

#include "server/http/gate.h"
#include "server/http/http_options.h"
#include "server/http/router.h"
#include "server/metrics/metrics.h"

namespace mapweld::server {

class HttpServer {
 public:
  // `metrics` and `gate` must outlive this; without a gate everybody is let in.
  // Throws std::runtime_error for a certificate or key that cannot be used.
  HttpServer(const HttpOptions& options, Router router, Metrics& metrics, Gate* gate = nullptr);
  ~HttpServer();  // after serve() has returned
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // Takes the port and returns its number. Throws std::runtime_error, saying why, when it cannot be had.
  int bind();

  // Runs the loop on this thread until drain() was called and the requests under way are answered. After bind().
  void serve();

  // Reads certificate and key again, for the connections to come. Throws std::runtime_error when they cannot be used,
  // and the former ones stay. Any thread; does nothing without TLS.
  void reload_certificate();

  std::size_t connections() const;  // open ones; any thread

  // Stops taking connections; requests under way are finished, each with "Connection: close". Any thread; idempotent.
  void drain();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mapweld::server
