// Two maps, every verified edge between them and inside them, and what is known of each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/evaluation/guard/guard_cases.h"
#include "tests/evaluation/places.h"
#include "tests/support/rendered_merge.h"

namespace mapweld::evaluation {

struct JudgedMerge {
  rendered::MadeMerge merge;
  std::vector<VerifiedEdge> inner;  // merged numbers
  // By edge of merge.inter_edges and of `inner`. Photographs: PhotographTruth. Rendered, between maps: right when both
  // images see 10 % of each other's view, wrong below 2 %, otherwise unknown (from near and from far the share is
  // small, and yet matches agree with depth in most of them); inside a map, on two storeys or more than 10 m apart
  // wrong, otherwise unknown.
  std::vector<Truth> inter_truth, inner_truth;
  // By merged vertex: what it shows, for people, and how many images it stands for: itself, and those that were ignored
  // because they resemble it (more than any other vertex).
  std::vector<std::string> shown;
  std::vector<std::uint32_t> images;
};

// Made and kept in `cache` as <name>.merge (and <name>.ignored), or read from there. The same whatever `threads`.
// Throws std::runtime_error when a folder has no photographs.
JudgedMerge judged_merge(const GuardCase& guard_case, const std::filesystem::path& cache, int threads);
bool is_cached(const GuardCase& guard_case, const std::filesystem::path& cache);

}  // namespace mapweld::evaluation
