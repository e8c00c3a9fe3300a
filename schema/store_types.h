// Values that several tables share.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "core/types.h"

namespace mapweld {

enum class VocabularyId : std::int64_t {};
enum class ImageId : std::int64_t {};  // row of an uploaded image, inserted or ignored; ascending in order of arrival
enum class EdgeId : std::int64_t {};   // row of an edge; ascending in order of insertion
enum class VerifierId : std::int64_t {};  // a verifier's version and parameters
enum class SegmentId : std::int64_t {};

// A time in UTC. The store never looks at a clock: the caller gives every time.
using Timestamp = std::chrono::sys_time<std::chrono::microseconds>;

using Sha256 = std::array<std::uint8_t, 32>;

// Where an image comes from, as its robot told (http-api.md). Kept for ignored images too.
struct Provenance {
  std::optional<Timestamp> captured_at;
  std::optional<std::string> sequence;  // name of the run that it is part of
  std::optional<std::int64_t> index;    // position in that run
  std::optional<std::string> camera;    // JSON of the contract; none: its map's
  std::optional<std::string> pose;      // likewise
  friend bool operator==(const Provenance&, const Provenance&) = default;
};

}  // namespace mapweld
