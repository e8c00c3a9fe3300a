// What the row of a map keeps as JSON: its parameters and labels.
#pragma once

#include <map>
#include <string>

#include "client/contract/map.h"
#include "core/mapping/localizer.h"
#include "schema/maps/map_store.h"

namespace mapweld::server {

struct MapSettings {
  MapParameters parameters;
  bool store_images = true;  // keep the uploaded bytes
};

// The settings of a new map: the defaults, with what the request says. The request has been checked.
MapSettings settings_of(const contract::MapParameters& requested);
// Of a stored map; what its row does not say has its default.
MapSettings settings_of(const MapRow& map);

// With what the request says put in place of what was; the rest stays. The request has been checked.
MapSettings changed(const MapSettings& before, const contract::MapParameters& requested);

// As JSON for a row, and for an answer: every field there.
contract::MapParameters describe(const MapSettings& settings);
std::string to_row(const MapSettings& settings);

std::map<std::string, std::string> labels_of(const MapRow& map);
std::string labels_to_row(const std::map<std::string, std::string>& labels);

}  // namespace mapweld::server
