// Table `map_cameras`: with what camera a plain map's images were taken, as JSON of the contract. An image may name
// another (Provenance::camera).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// Gives a map its camera in place of any that it has, or takes that away. Unless it has this one
// already, its revision grows, and those of the merged maps over it, of all levels.
void set_map_camera(WriteTransaction& db, MapId map, const std::optional<std::string>& camera);

std::optional<std::string> find_map_camera(const Reader& db, MapId map);

}  // namespace mapweld
