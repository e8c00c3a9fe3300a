// Merges made again from what is known of their pairs, and in which order they come upon verified edges.
#pragma once

#include <cstdint>
#include <vector>

#include "core/merge/merge_input.h"
#include "tests/evaluation/guard/judged_merge.h"

namespace mapweld::evaluation {

// A merge by `spectral` over the maps of `judged`, whose verifier knows the verdicts. `judged` must outlive it.
MergeInput known_merge(const JudgedMerge& judged, std::vector<Edge> inner_edges);

// Verifies nothing anew: a merge by `spectral` over the maps of `judged`, whose verifier knows the verdicts.
std::vector<MergeEdge> edges_as_found(const JudgedMerge& judged);

// At random, the same for the same seed.
std::vector<MergeEdge> edges_at_random(const JudgedMerge& judged, std::uint64_t seed);

}  // namespace mapweld::evaluation
