// What a key has, and what it may have.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/contract/codec.h"

namespace mapweld::contract {

struct Share {
  std::int64_t used = 0;
  std::optional<std::int64_t> max;  // null: no bound
  static constexpr auto fields() { return std::tuple(field("used", &Share::used), field("max", &Share::max)); }
  friend bool operator==(const Share&, const Share&) = default;
};

// GET /v1/quota
struct Quota {
  std::optional<std::string> key;  // its name; null: the server asks for none
  Share images;                    // vertices and ignored ones that came with it and are not deleted
  Share bytes;                     // that are kept of them
  Share queued_merges;             // queued or running
  static constexpr auto fields() {
    return std::tuple(field("key", &Quota::key), field("images", &Quota::images), field("bytes", &Quota::bytes),
                      field("queued_merges", &Quota::queued_merges));
  }
  friend bool operator==(const Quota&, const Quota&) = default;
};

}  // namespace mapweld::contract
