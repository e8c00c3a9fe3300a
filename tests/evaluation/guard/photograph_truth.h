// What is known of any two photographs of MAPWELD_PHOTOS: of one folder, of two, of two buildings.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/evaluation/places.h"

namespace mapweld::evaluation {

// A photograph by its folder below MAPWELD_PHOTOS and its file's name.
struct PhotographName {
  std::string folder, name;
};

// Beyond PlaceTruth: photographs of different buildings are wrong, and within one folder the museum's positions and the
// frame numbers of the twin storeys speak. Reads a place's files once. One thread.
class PhotographTruth {
 public:
  Truth of(const PhotographName& a, const PhotographName& b);

 private:
  std::map<std::pair<std::string, std::string>, PlaceTruth> known_;  // by folders
};

}  // namespace mapweld::evaluation
