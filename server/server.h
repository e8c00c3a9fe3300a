// The whole server in one object: data folder, services, jobs and HTTP, started and stopped in order.
#pragma once

#include <memory>

#include "server/config.h"

namespace mapweld::server {

class Server {
 public:
  // Opens the data folder, takes in the default vocabulary and takes the port. Merges that ran when the server stopped
  // go on. Throws StoreError (folder_in_use, foreign_database, newer_version, ...) and std::runtime_error, each with a
  // sentence for the one who starts the server; nothing is then running.
  explicit Server(const ServerConfig& config);
  ~Server();  // when run() is not running
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;

  // Serves until stop(). Returns when the requests under way are answered and running merges are checkpointed.
  void run();

  // Reads the certificate and its key again (HttpServer::reload_certificate). Any thread.
  void reload_certificate();

  // Any thread; returns at once. Takes no new requests; finishes those under way, but of large batches only the images
  // that it gets to within 3 s.
  void stop();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mapweld::server
