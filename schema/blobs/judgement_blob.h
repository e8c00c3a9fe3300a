// What an edge's confidence is made of, as bytes.
//
// Frame 'J', version 1 (byte_stream.h). Payload: varint n; then for each item a varint, the length of its name, the
// name in UTF-8, the value as a little-endian double, u8 1 and a double, its log-odds, or u8 0 where it has none.
#pragma once

#include <span>
#include <vector>

#include "core/guard/guard_evidence.h"
#include "schema/blobs/byte_stream.h"

namespace mapweld::blobs {

Bytes encode_judgement(std::span<const EvidenceItem> items);

// Throws StoreError (kCorrupt, kNewerVersion).
std::vector<EvidenceItem> decode_judgement(std::span<const std::uint8_t> blob);

}  // namespace mapweld::blobs
