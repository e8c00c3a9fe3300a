// The appearance vector of one image as bytes: 25 to 26 bytes an appearance with signatures, 9 to 10 without; exact.
//
// Frame 'A', version 3 when some of them are static, else 2 with signatures and 1 without (byte_stream.h). Payload:
// varint width_px, varint height_px, varint n; then n varints, each word's distance from the word before it (from 0 for
// the first); then four columns of n little-endian u16: x and y in 1/8 px, scale in 1/64 px, angle in 360/65536 degrees
// (the grid of core/vocabulary/appearance_vector.h). Versions 2 and 3 go on with n signatures of four little-endian u32
// each, version 3 with the static appearances, from their own n on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/retrieval/vote_signature.h"
#include "core/types.h"
#include "schema/blobs/byte_stream.h"

namespace mapweld::blobs {

// Throws FormatError when an appearance does not lie on the grid or the words do not ascend.
Bytes encode_appearances(const AppearanceVector& image);

// Bit for bit what was encoded. Throws StoreError (kCorrupt, kNewerVersion).
AppearanceVector decode_appearances(std::span<const std::uint8_t> blob);

// Only what an inverted index needs, nothing of what is static: the words, ascending, as often as they appear, and each
// with its signature for votes (core/retrieval/vote_signature.h).
struct IndexedFeatures {
  std::vector<WordId> words;
  std::vector<VoteSignature> signatures;
};
void decode_indexed(std::span<const std::uint8_t> blob, IndexedFeatures& features);

}  // namespace mapweld::blobs
