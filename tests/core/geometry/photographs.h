// Photographs from MAPWELD_PHOTOS as the server would see them, by the shipped vocabulary.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/types.h"

namespace mapweld::test {

struct Photograph {
  int number = 0;  // the first of its file name, or its place in the folder
  AppearanceVector appearances;
};

// Where the data sets are: MAPWELD_PHOTOS, or ../shared/data beside the source.
std::filesystem::path photographs_folder();

// The photographs of a folder of a data set, for example "corridor-two-laps/lap-1", by name; every `step`-th of them.
// Empty when it or the vocabulary is not here. Read once a process and folder; not thread-safe.
const std::vector<Photograph>& photographs(const std::string& folder, std::size_t step = 1);

// corridor-two-laps/same_place.csv as pairs of numbers (lap 1, lap 2).
std::set<std::pair<int, int>> corridor_same_place();

}  // namespace mapweld::test
