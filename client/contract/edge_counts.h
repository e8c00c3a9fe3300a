// How many edges there are, and how many of them count.
#pragma once

#include <cstdint>
#include <tuple>

#include "client/contract/codec.h"

namespace mapweld::contract {

// A verified edge says that two images agree, a confirmed one that they show one place; only confirmed edges are edges
// of the map (docs/http-api.md, "Two layers of edges").
struct EdgeCounts {
  std::int64_t verified = 0;
  std::int64_t confirmed = 0;  // of them
  static constexpr auto fields() {
    return std::tuple(field("verified", &EdgeCounts::verified), field("confirmed", &EdgeCounts::confirmed));
  }
  friend bool operator==(const EdgeCounts&, const EdgeCounts&) = default;
};

}  // namespace mapweld::contract
