// Made-up maps of any size, for what merging costs apart from the verifier.
#pragma once

#include <cstdint>

#include "core/merge/merge_input.h"

namespace mapweld::test {

// Two robots walk round the same loop. A place has landmarks, each with one of 50,000 words, frequent words more often
// (Zipf); an image sees those near it, misses some, and adds noise: 300 words an image. Method quickconnect, min_votes
// 12 by kMin; a verifier that takes no time and passes three pairs in ten.
MergeInput simulated_maps(std::uint32_t first, std::uint32_t second);

}  // namespace mapweld::test
