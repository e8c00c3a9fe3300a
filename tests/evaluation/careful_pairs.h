// What the careful matcher found, kept from run to run: FOLDER/<place>.csv with the columns a_name,b_name,inliers, one
// line for each joined pair.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/evaluation/careful_matcher.h"
#include "tests/evaluation/places.h"

namespace mapweld::evaluation {

struct CarefulPair {
  std::string a_name, b_name;
  int inliers = 0;
};

// Matches every photograph of one folder with every one of the other. The same whatever `threads`.
std::vector<CarefulPair> match_carefully(const Place& place, const CarefulMatcherOptions& options, int threads);

// nullopt when the place has not been matched yet; std::runtime_error for a file that is none.
std::optional<std::vector<CarefulPair>> read_careful_pairs(const std::filesystem::path& folder, const Place& place);
// Whole or not at all.
void write_careful_pairs(const std::filesystem::path& folder, const Place& place,
                         const std::vector<CarefulPair>& pairs);

}  // namespace mapweld::evaluation
