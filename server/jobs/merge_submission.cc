#include "server/jobs/merge_submission.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "client/contract/names.h"
#include "core/merge/merge_options.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/merges/merge_store.h"
#include "server/jobs/merge_job_rows.h"
#include "server/services/uuid.h"

namespace mapweld::server {
namespace {

[[noreturn]] void refuse(const char* code, const std::string& detail) { throw MergeJobError(code, detail); }

void check(const MergeParameters& parameters) {
  if (parameters.min_votes < 1 || parameters.min_votes > 65535) {
    refuse("invalid_parameter", "\"min_votes\" must be between 1 and 65535.");
  }
  if (parameters.min_inliers < 4 || parameters.min_inliers > 65535) {
    refuse("invalid_parameter", "\"min_inliers\" must be between 4 and 65535: fewer matches give no geometry.");
  }
  if (!(std::isfinite(parameters.max_false_alarms) && parameters.max_false_alarms > 0)) {
    refuse("invalid_parameter", "\"max_false_alarms\" must be greater than 0.");
  }
  if (!(parameters.min_confidence >= 0 && parameters.min_confidence <= 1)) {
    refuse("invalid_parameter", "\"min_confidence\" must be between 0 and 1.");
  }
}

std::vector<MapRow> require_members(const Reader& db, const MergeRequest& request) {
  std::vector<MapRow> members;
  std::set<MapId> seen;
  for (const std::string& name : request.maps) {
    std::optional<MapRow> map = find_map(db, name);
    if (!map) refuse("no_such_map", "There is no map named \"" + name + "\".");
    const MapLayout layout = load_layout(db, map->id);
    for (const LayoutNode& node : layout.nodes()) {
      if (!seen.insert(node.map).second) {
        refuse("duplicate_member", "\"" + name + "\" is part of another member: a map merges once.");
      }
    }
    require_settled(db, map->id, name);
    if (!members.empty() && map->vocabulary != members.front().vocabulary) {
      refuse("vocabulary_mismatch",
             "\"" + members.front().name + "\" and \"" + name + "\" have different vocabularies.");
    }
    members.push_back(std::move(*map));
  }
  return members;
}

}  // namespace

void check(const MergeRequest& request) {
  if (request.maps.size() < 2) refuse("too_few_members", "A merge takes two maps or more.");
  if (std::set<std::string>(request.maps.begin(), request.maps.end()).size() != request.maps.size()) {
    refuse("duplicate_member", "A map cannot be merged with itself.");
  }
  if (!contract::is_slug(request.name)) {
    refuse("invalid_name", "\"" + request.name + "\" cannot be the name of a map.");
  }
  if (std::ranges::find(merge_methods(), request.method) == merge_methods().end()) {
    refuse("unknown_method", "There is no method \"" + request.method + "\".");
  }
  check(request.parameters);
  contract::check(request.budget);
}

void require_settled(const Reader& db, MapId map, const std::string& name) {
  const std::optional<MergeRow> merge = find_merge_of(db, map);
  if (merge && (merge->state == JobState::kQueued || merge->state == JobState::kRunning)) {
    refuse("wrong_state", "The merge that makes \"" + name + "\" is not at rest; pause it or wait for it.");
  }
}

JobId store_submission(WriteTransaction& db, const MergeRequest& request, Timestamp now) {
  const std::vector<MapRow> members = require_members(db, request);
  if (find_map(db, request.name)) refuse("name_taken", "There is a map named \"" + request.name + "\" already.");
  std::vector<MapId> ids;
  for (const MapRow& member : members) ids.push_back(member.id);
  NewMap map;
  map.name = request.name;
  map.uuid = make_uuid();
  map.vocabulary = members.front().vocabulary;
  map.parameters = members.front().parameters;  // how images are localized in it
  map.created_at = now;
  NewMerge merge;
  merge.map = insert_merged_map(db, map, ids);
  merge.method = request.method;
  merge.seed = request.seed;
  merge.parameters = to_row(request.parameters);
  merge.budget = to_row(request.budget);
  merge.created_at = now;
  return insert_merge(db, merge);
}

}  // namespace mapweld::server
