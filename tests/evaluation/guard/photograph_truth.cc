#include "tests/evaluation/guard/photograph_truth.h"

#include <algorithm>

namespace mapweld::evaluation {
namespace {

// What shares no view with anything else. The two data sets of one office are one building.
std::string building_of(const std::string& folder) {
  const auto first = folder.find('/');
  const std::string set = folder.substr(0, first);
  if (set.starts_with("office-")) return "office";
  if (set == "places-two-visits") return folder.substr(0, folder.find('/', first + 1));
  return set;
}

// Two folders as a place: the one that is listed, or one of which no file says more than its folder's name does.
Place place_of(const std::string& a, const std::string& b) {
  if (building_of(a) != building_of(b)) return {"", a, b, true};
  for (const Place& place : places(true)) {
    if (place.a == a && place.b == b) return place;
  }
  return {a == b && a.starts_with("museum-region") ? "museum-region" : "", a, b, false};
}

}  // namespace

Truth PhotographTruth::of(const PhotographName& a, const PhotographName& b) {
  const auto is_listed = [&] {
    return std::ranges::any_of(places(true), [&](const Place& p) { return p.a == b.folder && p.b == a.folder; });
  };
  auto found = known_.find({a.folder, b.folder});
  if (found == known_.end()) {
    if (a.folder != b.folder && is_listed()) return of(b, a);
    found = known_.emplace(std::pair(a.folder, b.folder), PlaceTruth(place_of(a.folder, b.folder))).first;
  }
  return found->second.of(a.name, b.name);
}

}  // namespace mapweld::evaluation
