#include "client/contract/merge.h"

#include <algorithm>
#include <set>

#include "client/contract/checks.h"
#include "client/contract/names.h"

namespace mapweld::contract {

bool is_at_rest(std::string_view merge_state) { return merge_state != "queued" && merge_state != "running"; }

void check(const SubmitMerge& request) {
  for (const std::string& map : request.maps) check_slug(map, "A map's name");
  if (request.maps.size() < 2) throw ContractError("too_few_members", "\"maps\" must name two maps or more.");
  std::set<std::string> seen;
  for (const std::string& map : request.maps) {
    if (!seen.insert(map).second) throw ContractError("duplicate_member", "\"maps\" names \"" + map + "\" twice.");
  }
  if (request.name) check_slug(*request.name, "The merged map's name");
  if (request.method && std::find(kMergeMethods.begin(), kMergeMethods.end(), *request.method) == kMergeMethods.end()) {
    throw ContractError("unknown_method", "There is no method \"" + *request.method + "\".");
  }
  if (request.seed && *request.seed < 0) throw ContractError("invalid_parameter", "\"seed\" must be 0 or more.");
  if (request.parameters) {
    check_range(request.parameters->min_votes, "parameters.min_votes", 1, 65535);
    check_range(request.parameters->min_inliers, "parameters.min_inliers", 1, 65535);
    if (request.parameters->max_false_alarms && !(*request.parameters->max_false_alarms > 0)) {
      throw ContractError("invalid_parameter", "\"parameters.max_false_alarms\" must be greater than 0.");
    }
    check_range(request.parameters->min_confidence, "parameters.min_confidence", 0.0, 1.0);
    check_one_of(request.parameters->votes, "parameters.votes", {"min", "product", "signatures"});
  }
  if (request.budget) check(*request.budget);
}

std::string default_merge_name(const std::vector<std::string>& maps) {
  std::string name;
  for (const std::string& map : maps) name += (name.empty() ? "" : "_") + map;
  return name.substr(0, 64);
}

void check(const RunMerge& request) {
  if (request.budget) check(*request.budget);
}

}  // namespace mapweld::contract
