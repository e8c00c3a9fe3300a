#include "tests/evaluation/places.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace mapweld::evaluation {
namespace {

namespace fs = std::filesystem;

constexpr double kMuseumFar_m = 8;
constexpr int kCorridorWiden = 2;
constexpr int kTwinNearFrames = 25;

int number_of(const std::string& name) {
  const auto digit = name.find_first_of("0123456789");
  return digit == std::string::npos ? -1 : std::atoi(name.c_str() + digit);
}

std::vector<std::vector<std::string>> read_csv(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

std::string last_part(const std::string& folder) { return fs::path(folder).filename(); }

struct Walk {
  std::string storey, folder, short_name;
};

// Pairs of walks: those on one storey, or those on two.
void add_pairs(std::vector<Place>& places, const std::string& prefix, const std::vector<Walk>& walks, bool of_one) {
  for (std::size_t i = 0; i < walks.size(); ++i) {
    for (std::size_t j = i + 1; j < walks.size(); ++j) {
      const bool one_storey = walks[i].storey == walks[j].storey;
      if (one_storey != of_one) continue;
      const std::string name =
          one_storey ? prefix + walks[i].storey : prefix + walks[i].short_name + "-" + prefix + walks[j].short_name;
      places.push_back({name, walks[i].folder, walks[j].folder, !one_storey});
    }
  }
}

}  // namespace

std::vector<Place> places(bool between_storeys) {
  std::vector<Place> places{
      {"museum-region", "museum-region/a", "museum-region/b"},
      {"corridor-two-laps", "corridor-two-laps/lap-1", "corridor-two-laps/lap-2"},
      {"office-two-rings", "office-two-rings/a", "office-two-rings/b"},
      {"office-two-runs", "office-two-runs/reference", "office-two-runs/live"},
      {"magasin", "places-two-visits/magasin/A", "places-two-visits/magasin/B"},
      {"studio", "places-two-visits/studio/A", "places-two-visits/studio/B"},
  };
  std::vector<Walk> tower, twins;
  for (const char* storey : {"04", "09", "17", "19"}) {
    for (const char* walk : {"1", "2"}) {
      if (storey == std::string("19") && walk == std::string("2")) continue;
      tower.push_back(
          {storey, std::string("tower-storeys/storey-") + storey + "/walk-" + walk, std::string(storey) + "." + walk});
    }
  }
  for (const char* storey : {"2", "3"}) {
    for (const char* part : {"a", "b"}) {
      twins.push_back(
          {storey, std::string("twin-storeys/storey-") + storey + "/part-" + part, std::string(storey) + part});
    }
  }
  add_pairs(places, "tower-", tower, true);
  add_pairs(places, "twin-", twins, true);
  if (between_storeys) {
    add_pairs(places, "tower-", tower, false);
    add_pairs(places, "twin-", twins, false);
  }
  return places;
}

fs::path photographs_folder() {
  const char* set = std::getenv("MAPWELD_PHOTOS");
  return set != nullptr && *set != '\0' ? fs::path(set) : fs::path(MAPWELD_SOURCE_DIR) / ".." / "shared" / "data";
}

std::vector<std::string> photograph_names(const std::string& folder) {
  std::vector<std::string> names;
  const fs::path path = photographs_folder() / folder;
  if (!fs::is_directory(path)) return names;
  for (const auto& entry : fs::directory_iterator(path)) {
    const auto ending = entry.path().extension();
    if (ending == ".jpg" || ending == ".jpeg" || ending == ".png") names.push_back(entry.path().filename());
  }
  std::ranges::sort(names);
  return names;
}

PlaceTruth::PlaceTruth(const Place& place) : place_(place) {
  if (place.name == "museum-region") {
    for (const auto& row : read_csv(photographs_folder() / "museum-region" / "positions.csv")) {
      if (row.size() == 4) position_m_[row[0] + "/" + row[1]] = {std::atof(row[2].c_str()), std::atof(row[3].c_str())};
    }
  } else if (place.name == "corridor-two-laps") {
    for (const auto& row : read_csv(photographs_folder() / "corridor-two-laps" / "same_place.csv")) {
      if (row.size() == 2) same_place_.emplace(number_of(row[1]), number_of(row[0]));  // lap 1, lap 2
    }
  }
}

Truth PlaceTruth::of(const std::string& a_name, const std::string& b_name) const {
  if (place_.shares_nothing) return Truth::kWrong;
  if (!position_m_.empty()) {
    const auto a = position_m_.find(last_part(place_.a) + "/" + a_name);
    const auto b = position_m_.find(last_part(place_.b) + "/" + b_name);
    if (a == position_m_.end() || b == position_m_.end()) return Truth::kUnknown;
    const double distance_m = std::hypot(a->second.first - b->second.first, a->second.second - b->second.second);
    return distance_m > kMuseumFar_m ? Truth::kWrong : Truth::kUnknown;
  }
  const int a = number_of(a_name), b = number_of(b_name);
  if (!same_place_.empty()) {
    const bool near = std::ranges::any_of(same_place_, [&](const auto& pair) {
      return std::abs(pair.first - a) <= kCorridorWiden && std::abs(pair.second - b) <= kCorridorWiden;
    });
    return near ? Truth::kRight : Truth::kWrong;
  }
  if (place_.a.starts_with("places-two-visits")) return a_name == b_name ? Truth::kRight : Truth::kUnknown;
  if (place_.a.starts_with("twin-storeys")) return std::abs(a - b) <= kTwinNearFrames ? Truth::kRight : Truth::kUnknown;
  return Truth::kUnknown;
}

}  // namespace mapweld::evaluation
