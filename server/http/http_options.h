// What the HTTP server takes at most, and where it listens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace mapweld::server {

struct ConnectionLimits {
  std::size_t max_head_bytes = 16 * 1024;      // request line and header fields together
  std::size_t max_target_bytes = 8 * 1024;     // path and query
  int idle_timeout_ms = 5'000;                 // a kept-alive connection without a request
  int head_timeout_ms = 10'000;                // from the first byte of a head to its last; a TLS handshake
  int body_idle_timeout_ms = 10'000;           // between two pieces of a body
  int body_timeout_ms = 120'000;               // a whole body, unless it becomes a file
  int write_timeout_ms = 10'000;               // between two pieces of a reply
  int rate_grace_ms = 10'000;                  // after that long, a body and a piece of a reply must on the whole
  std::uint64_t min_rate_bytes_per_s = 1'000;  // have moved as fast as this
  int event_heartbeat_ms = 15'000;             // a comment, when there is nothing else to tell
  int linger_ms = 1'000;                       // before closing on a client that still sends
};

struct HttpOptions {
  std::string host = "127.0.0.1";
  int port = 8080;                                        // 0: any free one
  std::vector<std::string> allowed_hosts = {};            // host names that requests may be for, beside host_names.h's
  std::string tls_certificate = {};                       // PEM file, with those that vouch for it; empty: no TLS
  std::string tls_key = {};                               // PEM file
  int threads = 32;                                       // requests worked on at the same time
  std::size_t max_waiting = 256;                          // requests that may wait for a thread; more get 503 busy
  std::size_t max_connections = 4096;                     // at the same time, as far as there are descriptors
  std::size_t max_body_bytes = 64 * 1024 * 1024;          // of one request
  std::size_t max_bodies_bytes = 512 * 1024 * 1024;       // of all requests together; more get 503 busy
  std::size_t max_json_bytes = 1024 * 1024;               // of a JSON document
  std::filesystem::path body_folder = {};                 // for bodies that become files; there when the server runs
  std::uint64_t max_file_bytes = std::uint64_t{1} << 40;  // of such a body; the disk ends it sooner
  int max_requests_per_connection = 100'000;
  ConnectionLimits connection = {};
};

}  // namespace mapweld::server
