// SIFT descriptors of photographs that the shipped vocabulary was not trained on, for benchmarks of words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mapweld::test {

// Descriptors (N x 128 bytes) of every `step`-th photograph of the test sets, the strongest 500 of each, in order of
// the files' names; at most `limit`. Empty when the data sets are not here (MAPWELD_PHOTOS).
std::vector<std::uint8_t> photograph_descriptors(std::size_t step, std::size_t limit);

// The shipped vocabulary file's bytes.
std::vector<std::uint8_t> shipped_vocabulary_file();

}  // namespace mapweld::test
