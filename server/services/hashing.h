// SHA-256 and random ids.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "schema/store_types.h"

namespace mapweld::server {

Sha256 sha256(std::span<const std::uint8_t> bytes);

std::string to_hex(const Sha256& hash);

// A version 4 UUID (RFC 9562), lower case.
std::string make_uuid();

}  // namespace mapweld::server
