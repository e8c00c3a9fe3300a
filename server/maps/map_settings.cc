#include "server/maps/map_settings.h"

#include "client/contract/json.h"

namespace mapweld::server {

using contract::Json;

MapSettings settings_of(const contract::MapParameters& requested) {
  MapSettings settings;
  MapParameters& p = settings.parameters;
  p.max_features = requested.max_features.value_or(p.max_features);
  p.min_inliers = requested.min_inliers.value_or(p.min_inliers);
  p.max_inliers = requested.max_inliers.value_or(p.max_inliers);
  p.verify_top = requested.verify_top.value_or(p.verify_top);
  if (requested.votes) p.votes = parse_vote_rule(*requested.votes).value_or(p.votes);
  p.min_votes = requested.min_votes ? static_cast<std::uint32_t>(*requested.min_votes) : default_min_votes(p.votes);
  if (requested.store_images) settings.store_images = *requested.store_images == "full";
  return settings;
}

MapSettings settings_of(const MapRow& map) {
  return settings_of(contract::parse_json(map.parameters).get<contract::MapParameters>());
}

MapSettings changed(const MapSettings& before, const contract::MapParameters& requested) {
  contract::Json all = describe(before);
  all.update(contract::Json(requested));
  return settings_of(all.get<contract::MapParameters>());
}

contract::MapParameters describe(const MapSettings& settings) {
  const MapParameters& p = settings.parameters;
  return {.max_features = p.max_features,
          .min_votes = static_cast<int>(p.min_votes),
          .min_inliers = p.min_inliers,
          .max_inliers = p.max_inliers,
          .verify_top = p.verify_top,
          .votes = std::string(to_string(p.votes)),
          .store_images = settings.store_images ? "full" : "none"};
}

std::string to_row(const MapSettings& settings) { return contract::dump(Json(describe(settings))); }

std::map<std::string, std::string> labels_of(const MapRow& map) {
  std::map<std::string, std::string> labels;
  const Json stored = contract::parse_json(map.labels);
  for (const auto& [key, value] : stored.items()) {
    if (value.is_string()) labels[key] = value.get<std::string>();
  }
  return labels;
}

std::string labels_to_row(const std::map<std::string, std::string>& labels) {
  Json json = Json::object();
  for (const auto& [key, value] : labels) json[key] = value;
  return contract::dump(json);
}

}  // namespace mapweld::server
