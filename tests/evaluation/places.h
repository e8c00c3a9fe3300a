// The real places of MAPWELD_PHOTOS as pairs of folders, with what is known of who sees whom.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mapweld::evaluation {

// Two folders of photographs that a merge would bring together. `name` is used for files.
struct Place {
  std::string name;
  std::string a, b;             // below MAPWELD_PHOTOS
  bool shares_nothing = false;  // two storeys that look alike: every edge between the folders is wrong
};

// The real places; `between_storeys`: also the pairs of walks on different storeys of the tower and of the twin
// storeys.
std::vector<Place> places(bool between_storeys);

// Where the data sets are: MAPWELD_PHOTOS, or ../shared/data beside the source.
std::filesystem::path photographs_folder();

// Names of a folder's photographs, ascending; empty when it is not here.
std::vector<std::string> photograph_names(const std::string& folder);

// What is known of a pair of photographs. `kUnknown`: nobody wrote it down.
enum class Truth : std::uint8_t { kRight, kWrong, kUnknown };

// Reads what a place's own files say; the name of a photograph is that of its file.
//   museum-region         positions: further apart than 8 m wrong, otherwise unknown (the direction of view is not
//   given) corridor-two-laps     same_place.csv, widened by two images on either lap: right, otherwise wrong
//   places-two-visits     same file name right, otherwise unknown
//   twin-storeys          one storey: at most 25 frames apart right, otherwise unknown
//   two storeys           wrong
class PlaceTruth {
 public:
  explicit PlaceTruth(const Place& place);
  Truth of(const std::string& a_name, const std::string& b_name) const;

 private:
  Place place_;
  std::map<std::string, std::pair<double, double>> position_m_;  // "a/000.jpg"
  std::set<std::pair<int, int>> same_place_;
};

}  // namespace mapweld::evaluation
