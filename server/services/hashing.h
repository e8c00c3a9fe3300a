// SHA-256.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "schema/store_types.h"

namespace mapweld::server {

Sha256 sha256(std::span<const std::uint8_t> bytes);

std::string to_hex(const Sha256& hash);

}  // namespace mapweld::server
