// A merge's checkpoint whose frames and compression are right: pieces of a number (which part), a length (16 bits,
// little-endian) and the part's content. Refused, or written again as the same.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "schema/blobs/merge_state_blob.h"
#include "schema/blobs/merge_state_content.h"
#include "schema/engine/store_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mapweld;
  constexpr const char* kNames[] = {"state", "similarity", "queue", "postponed", "rejected-000000", "absent"};
  std::vector<blobs::MergeStatePart> parts;
  const std::uint8_t* const end = data + size;
  while (end - data >= 3 && parts.size() < 8) {
    const std::size_t length = std::min<std::size_t>(data[1] + 256 * data[2], end - data - 3);
    blobs::MergeStateContent content;
    for (std::size_t i = 0; i < length; ++i) content.u8(data[3 + i]);
    parts.push_back(std::move(content).pack(kNames[data[0] % std::size(kNames)]));
    data += 3 + length;
  }
  try {
    const MergeState state = blobs::decode_merge_state(parts, {});
    const MergeState again = blobs::decode_merge_state(blobs::encode_merge_state(state, {}), {});
    if (again.step != state.step || again.rejected.size() != state.rejected.size() ||
        again.search.postponed.size() != state.search.postponed.size()) {
      std::abort();
    }
  } catch (const StoreError&) {
  }
  return 0;
}
