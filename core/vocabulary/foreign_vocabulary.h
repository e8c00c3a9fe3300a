// Vocabulary files that this program may not have written.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/vocabulary/vocabulary.h"

namespace mapweld {

// As Vocabulary::deserialize, of bytes that nobody vouches for. FLANN trusts its archives, and hostile ones overwrite
// memory: an index of it is built anew from the words, with the default options, and must be the file's to the byte.
// That takes as long as its training took; the other engines look at what they read. Throws FormatError.
std::shared_ptr<const Vocabulary> deserialize_foreign(std::span<const std::uint8_t> bytes);

}  // namespace mapweld
