// What guard_figures prints: lines of Markdown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/evaluation/guard/guard_counts.h"
#include "tests/evaluation/guard/guard_prefixes.h"

namespace mapweld::evaluation {

void print_counts_head();
void print_counts(const std::string& title, const GuardCounts& counts);
void print_prefixes_head();
void print_prefixes(const std::string& title, const PrefixFigures& figures);
// Confirmed edges that are known to be wrong, with what their confidence is made of.
void print_wrong_confirmed(const JudgedMerge& judged, const GuardRun& run);
// So many confirmed edges at random, to be looked at: "a file,b file,confidence,inliers".
void print_sample(const JudgedMerge& judged, const GuardRun& run, std::size_t most, std::uint64_t seed);

}  // namespace mapweld::evaluation
