// What `mapweld-server serve` can be told (docs/operations.md, "Options").
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "server/access/access_gate.h"
#include "server/http/http_server.h"
#include "server/log.h"

namespace mapweld::server {

struct ServerConfig {
  std::filesystem::path data;
  HttpOptions http;
  AccessOptions access;
  bool read_only = false;                           // serve what is there, and change nothing
  bool insecure = false;                            // any address may be listened on without keys
  int extract_threads = 0;                          // 0: one a core
  int decoders = 0;                                 // processes for decoding; 0: none; -1: one for each of those
  int merge_workers = 1;                            // merges that run at the same time
  int verify_threads = 0;                           // on which merges verify pairs; 0: one a core
  double checkpoint_interval_s = 0.5;               // of a running merge, where checkpoints are cheap enough
  std::size_t cache_mb = 1024;                      // maps kept in memory
  std::optional<std::filesystem::path> vocabulary;  // default vocabulary; none: the shipped one
  std::string log_level = "info";                   // trace, debug, info, warning, error, off
  LogFormat log_format = LogFormat::kText;
};

// The shipped vocabulary: beside the installed program (../share/mapweld/vocabularies), or in the source tree that it
// was built from. nullopt when there is neither.
std::optional<std::filesystem::path> find_shipped_vocabulary();

}  // namespace mapweld::server
