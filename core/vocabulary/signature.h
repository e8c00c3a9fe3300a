// The binary signature of a descriptor.
#pragma once

#include <cstdint>
#include <span>

#include "core/types.h"

namespace mapweld {

// Bit i is set when component i is greater than the upper median of all 128 (the 65th in ascending order), so that at
// most 63 are; a descriptor that has no such component gets bit 0. Never zero.
Signature signature_of(std::span<const std::uint8_t, kDescriptorDimension> descriptor);

}  // namespace mapweld
