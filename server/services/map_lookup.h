// Looking up what requests name, with the contract's answer when it is not there.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "client/contract/problem.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_removal.h"
#include "schema/store.h"

namespace mapweld::server {

// Throws ContractError no_such_map.
inline MapRow require_map(const Reader& db, std::string_view name) {
  if (const std::optional<MapRow> map = find_map(db, name)) return *map;
  throw contract::ContractError("no_such_map", "There is no map named \"" + std::string(name) + "\".");
}

// Where a vertex of a map lives. Throws ContractError no_such_vertex for a number beyond the map, and for one whose
// image was deleted.
inline LeafVertex require_vertex(const Reader& db, const MapRow& map, const MapLayout& layout, std::uint32_t vertex) {
  const std::string name = "vertex " + std::to_string(vertex);
  if (vertex >= layout.vertices()) {
    throw contract::ContractError("no_such_vertex", "The map \"" + map.name + "\" has no " + name + ".");
  }
  const LeafVertex leaf = layout.leaf(VertexId{vertex});
  const VertexStanding standing = standing_of(db, leaf.map, leaf.vertex);
  if (standing == VertexStanding::kThere) return leaf;
  throw contract::ContractError("no_such_vertex", "Of the map \"" + map.name + "\", " + name + " was deleted" +
                                                      (standing == VertexStanding::kDeleted ? "." : " and purged."));
}

// The same of a plain map. Throws ContractError map_is_merged for a merged one, of which `instead` says what holds: a
// sentence's end.
inline MapRow require_plain_map(const Reader& db, std::string_view name, std::string_view instead) {
  MapRow map = require_map(db, name);
  if (map.kind != MapKind::kMerged) return map;
  throw contract::ContractError("map_is_merged",
                                "\"" + std::string(name) + "\" is a merged map; " + std::string(instead));
}

// Names of maps by id, each read once.
class MapNames {
 public:
  explicit MapNames(const Reader& db) : db_(db) {}
  const std::string& operator()(MapId id) {
    const auto found = names_.find(id);
    if (found != names_.end()) return found->second;
    const std::optional<MapRow> map = find_map(db_, id);
    return names_.emplace(id, map ? map->name : "").first->second;
  }

 private:
  const Reader& db_;
  std::map<MapId, std::string> names_;
};

}  // namespace mapweld::server
