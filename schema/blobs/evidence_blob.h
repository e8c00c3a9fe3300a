// What makes an edge believable, as bytes: the geometry between its two views and the inlier matches.
//
// Frame 'E', version 1 (byte_stream.h). Payload: u8 kind (0 none, 1 fundamental, 2 homography); nine little-endian
// doubles, the 3x3 matrix row by row; varint n; then for each match a varint, its first index's distance from that of
// the match before it, and a zigzag varint, the same for the second index (both from 0).
#pragma once

#include <cstdint>
#include <span>

#include "core/types.h"
#include "schema/blobs/byte_stream.h"

namespace mapweld::blobs {

// Keeps `kind`, `geometry` and `inlier_matches`. Throws FormatError when the matches do not ascend.
Bytes encode_evidence(const Verification& verification);

// Fills in what encode_evidence kept and leaves the rest. Throws StoreError (kCorrupt, kNewerVersion).
void decode_evidence(std::span<const std::uint8_t> blob, Verification& verification);

}  // namespace mapweld::blobs
