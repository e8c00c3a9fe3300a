// In which order a merge comes upon its verified edges.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/evaluation/guard/judged_merge.h"

namespace mapweld::evaluation {

// Verifies nothing anew: a merge by `spectral` over the maps of `judged`, whose verifier knows the verdicts.
std::vector<MergeEdge> edges_as_found(const JudgedMerge& judged);

// At random, the same for the same seed.
std::vector<MergeEdge> edges_at_random(const JudgedMerge& judged, std::uint64_t seed);

}  // namespace mapweld::evaluation
