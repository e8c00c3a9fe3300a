// Times as the contract writes them (RFC 3339, UTC), and what time it is.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "schema/store_types.h"

namespace mapweld::server {

Timestamp now();

// "2026-11-23T10:00:00Z", with a fraction ("…00.25Z") where there is one.
std::string to_rfc3339(Timestamp time);

// With "Z" or an offset ("+01:00"); a fraction counts to the microsecond. nullopt for what is no such time.
std::optional<Timestamp> parse_rfc3339(std::string_view text);

}  // namespace mapweld::server
