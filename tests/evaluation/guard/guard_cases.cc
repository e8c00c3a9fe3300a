#include "tests/evaluation/guard/guard_cases.h"

#include <algorithm>
#include <stdexcept>

#include "tests/evaluation/places.h"
#include "tests/support/merge_scenarios.h"

namespace mapweld::evaluation {
namespace {

GuardCase of_photographs(std::string name, std::string group, std::vector<std::string> a, std::vector<std::string> b) {
  return {std::move(name), std::move(group), std::move(a), std::move(b), "", 0, {}};
}

// "2a" of the twin storeys, "04.1" of the tower.
std::string twin(const std::string& part) {
  return "twin-storeys/storey-" + part.substr(0, 1) + "/part-" + part.substr(1);
}
std::string tower(const std::string& walk) {
  return "tower-storeys/storey-" + walk.substr(0, 2) + "/walk-" + walk.substr(3);
}

void add_both_storeys(std::vector<GuardCase>& cases) {
  const auto add = [&](const auto& folder, const std::string& prefix, const std::vector<std::string>& a,
                       const std::vector<std::string>& b) {
    GuardCase c{prefix, "", {}, {}, "", 0, {}};
    const auto take = [&](const std::vector<std::string>& parts, std::vector<std::string>& folders, char before) {
      for (const std::string& part : parts) {
        c.name += before + part;
        folders.push_back(folder(part));
        before = '+';
      }
    };
    take(a, c.a, '-');
    take(b, c.b, '-');
    c.group = c.name;
    cases.push_back(c);
  };
  add(twin, "twins", {"2a", "3a"}, {"2b"});
  add(twin, "twins", {"2a", "3a"}, {"3b"});
  add(twin, "twins", {"2a", "3b"}, {"2b"});
  add(twin, "twins", {"2a", "3a"}, {"2b", "3b"});
  add(tower, "towers", {"04.1", "09.1"}, {"04.2", "09.2"});
  add(tower, "towers", {"17.1", "19.1"}, {"17.2", "04.1"});
  add(tower, "towers", {"04.1", "09.1", "17.1", "19.1"}, {"04.2", "09.2", "17.2"});
}

void add_unrelated(std::vector<GuardCase>& cases) {
  const std::vector<std::pair<std::string, std::string>> buildings{{"museum", "museum-region/a"},
                                                                   {"office", "office-two-rings/a"},
                                                                   {"corridor", "corridor-two-laps/lap-1"},
                                                                   {"magasin", "places-two-visits/magasin/A"},
                                                                   {"studio", "places-two-visits/studio/A"},
                                                                   {"tower", tower("04.1")},
                                                                   {"twin", twin("2a")}};
  for (std::size_t i = 0; i < buildings.size(); ++i) {
    for (std::size_t j = i + 1; j < buildings.size(); ++j) {
      cases.push_back(of_photographs("unrelated-" + buildings[i].first + "-" + buildings[j].first, "unrelated places",
                                     {buildings[i].second}, {buildings[j].second}));
    }
  }
}

}  // namespace

std::vector<GuardCase> real_cases() {
  std::vector<GuardCase> cases;
  for (const Place& place : places(true)) {
    const bool of_tower = place.name.starts_with("tower");
    const std::string group = !place.shares_nothing ? place.name
                              : of_tower            ? "tower, between storeys"
                                                    : "twin, between storeys";
    cases.push_back(of_photographs(place.name, group, {place.a}, {place.b}));
  }
  add_both_storeys(cases);
  add_unrelated(cases);
  return cases;
}

std::vector<GuardCase> rendered_cases(const std::vector<std::string>& scenarios,
                                      const std::vector<std::uint64_t>& seeds) {
  const auto& all = rendered::merge_scenarios();
  for (const std::string& name : scenarios) {
    if (std::ranges::find(all, name, &rendered::MergeScenario::name) == all.end()) {
      throw std::invalid_argument("no scenario " + name);
    }
  }
  std::vector<GuardCase> cases;
  for (const rendered::MergeScenario& scenario : all) {
    const std::string name(scenario.name);
    if (!scenarios.empty() && std::ranges::find(scenarios, name) == scenarios.end()) continue;
    for (const std::uint64_t seed : seeds) {
      cases.push_back({name + "-" + std::to_string(seed), name, {}, {}, name, seed, {}});
    }
  }
  return cases;
}

std::vector<GuardCase> chosen_cases(const std::vector<std::string>& names, const std::vector<std::string>& scenarios,
                                    const std::vector<std::uint64_t>& seeds) {
  std::vector<GuardCase> cases = seeds.empty() ? real_cases() : rendered_cases(scenarios, seeds);
  const auto is_named = [&names](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
  if (!names.empty()) {
    std::erase_if(cases, [&](const GuardCase& c) { return !is_named(c.name) && !is_named(c.group); });
  }
  return cases;
}

GuardCase in_order(GuardCase guard_case, const UploadOrder& order) {
  guard_case.order = order;
  guard_case.name += upload_order_suffix(order);
  guard_case.group += upload_order_suffix(order);
  return guard_case;
}

}  // namespace mapweld::evaluation
