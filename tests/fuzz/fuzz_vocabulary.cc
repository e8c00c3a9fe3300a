// The index of a vocabulary file whose frame is right: the first byte says of which engine, the second of how many
// words, the rest is the index. Refused, or every word that it finds is one of them. Not FLANN's, which is never read
// of others (foreign_vocabulary.h).
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "core/errors.h"
#include "core/vocabulary/word_index.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mapweld;
  if (size < 2) return 0;
  constexpr const char* kEngines[] = {"hnsw", "exact"};
  const std::uint32_t words = 1 + data[1] % 64;
  alignas(64) static std::uint8_t centroids[64 * kDescriptorDimension];
  for (std::size_t i = 0; i < words * kDescriptorDimension; ++i) {
    centroids[i] = static_cast<std::uint8_t>(i * 2'654'435'761U >> 13);
  }
  const std::span own(centroids, words * kDescriptorDimension);
  try {
    const auto index = load_word_index(own, kEngines[data[0] % 2], {data + 2, size - 2});
    std::vector<WordId> found(words);
    index->quantise(own, found);
    for (const WordId word : found) {
      if (to_index(word) >= words) std::abort();
    }
  } catch (const FormatError&) {
  }
  return 0;
}
