// Blobs whose frame and checksum are right and whose payload is anything: the first byte says which format, the second
// which version. Decoded, or refused as corrupt.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <utility>

#include "core/errors.h"
#include "schema/blobs/appearance_blob.h"
#include "schema/blobs/evidence_blob.h"
#include "schema/blobs/judgement_blob.h"
#include "schema/blobs/posting_blob.h"
#include "schema/engine/store_error.h"

namespace {

using namespace mapweld;

blobs::Bytes framed(char format, std::uint8_t version, std::span<const std::uint8_t> payload) {
  blobs::ByteWriter writer(format, version);
  writer.raw(payload);
  return std::move(writer).finish();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::uint8_t version = data[1] % 4;
  const std::span payload(data + 2, size - 2);
  try {
    switch (data[0] % 4) {
      case 0: {
        const AppearanceVector image = blobs::decode_appearances(framed('A', version, payload));
        if (blobs::decode_appearances(blobs::encode_appearances(image)) != image) std::abort();
        break;
      }
      case 1: {
        Verification verification;
        blobs::decode_evidence(framed('E', version, payload), verification);
        break;
      }
      case 2:
        blobs::decode_judgement(framed('J', version, payload));
        break;
      default: {
        const blobs::Bytes blob = framed('P', version, payload);
        const blobs::PostingBlock block(blob, VertexId{7}, 100);
        PostingList postings;
        block.find(WordId{data[2 % size]}, postings);
      }
    }
  } catch (const StoreError&) {
  } catch (const FormatError&) {
  }
  return 0;
}
