// The merges that the alias guard is shown on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/evaluation/guard/upload_order.h"

namespace mapweld::evaluation {

// Two maps: of photographs, or of a rendered scenario.
struct GuardCase {
  std::string name;   // used for files
  std::string group;  // cases of one group are summed
  // Folders below MAPWELD_PHOTOS that each map is made of, one after the other; empty for a rendered case.
  std::vector<std::string> a, b;
  std::string scenario;  // tests/support/merge_scenarios.h; empty for photographs
  std::uint64_t seed = 0;
  UploadOrder order;  // of the photographs of either map
  bool is_rendered() const { return !scenario.empty(); }
};

// Every real place; walks and parts on one storey; each pair of walks on two storeys of the tower and of the twin
// storeys; maps that hold several storeys; each of the buildings against each other one.
std::vector<GuardCase> real_cases();

// std::invalid_argument for a scenario that there is not; no names: all.
std::vector<GuardCase> rendered_cases(const std::vector<std::string>& scenarios,
                                      const std::vector<std::uint64_t>& seeds);

// Of rendered_cases, or of real_cases when there are no seeds, those whose name or group is among `names`; no names:
// all.
std::vector<GuardCase> chosen_cases(const std::vector<std::string>& names, const std::vector<std::string>& scenarios,
                                    const std::vector<std::uint64_t>& seeds);

// A case of photographs, uploaded in this order, with a name of its own.
GuardCase in_order(GuardCase guard_case, const UploadOrder& order);

}  // namespace mapweld::evaluation
