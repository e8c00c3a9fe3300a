// The HTTP/1.1 server: sockets, threads, limits and request ids around the router. Knows no use case.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "server/http/connection.h"
#include "server/http/gate.h"
#include "server/http/router.h"
#include "server/metrics/metrics.h"

namespace mapweld::server {

struct HttpOptions {
  std::string host = "127.0.0.1";
  int port = 8080;                                   // 0: any free one
  int threads = 32;                                  // connections served at the same time
  std::size_t max_waiting = 256;                     // connections that may wait for a thread; more get 503 busy
  std::size_t max_body_bytes = 64 * 1024 * 1024;     // of one request
  std::size_t max_bodies_bytes = 512 * 1024 * 1024;  // of all requests together; more get 503 busy
  std::size_t max_json_bytes = 1024 * 1024;          // of a JSON document
  int max_requests_per_connection = 100'000;
  ConnectionLimits connection;
};

class HttpServer {
 public:
  // `metrics` and `gate` must outlive this. Without a gate everybody is let in.
  HttpServer(const HttpOptions& options, Router router, Metrics& metrics, Gate* gate = nullptr);
  ~HttpServer();  // after serve() has returned
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // Takes the port and returns its number. Throws std::runtime_error, saying why, when it cannot be had.
  int bind();

  // Serves until drain() was called and the requests under way are answered. After bind().
  void serve();

  // Stops taking connections; requests under way are finished, each with "Connection: close". Any thread; idempotent.
  void drain();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mapweld::server
