// Backups of a whole server.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/contract/codec.h"

namespace mapweld::contract {

// GET /v1/backups/{backup}
struct Backup {
  std::int64_t id = 0;                // when it was begun, in seconds since 1970
  std::string state;                  // "running", "completed", "failed"
  double progress = 0;                // 0 to 1
  std::optional<std::int64_t> bytes;  // of its file, once it is completed
  std::optional<std::string> error;   // why it failed
  std::string created_at;             // RFC 3339, UTC
  static constexpr auto fields() {
    using B = Backup;
    return std::tuple(field("id", &B::id), field("state", &B::state), field("progress", &B::progress),
                      field("bytes", &B::bytes), field("error", &B::error), field("created_at", &B::created_at));
  }
  friend bool operator==(const Backup&, const Backup&) = default;
};

}  // namespace mapweld::contract
