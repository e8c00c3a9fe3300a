// The way through a map: what to navigate along from one image to another.
#pragma once

#include <cstdint>
#include <string>

#include "client/contract/route.h"
#include "schema/store.h"

namespace mapweld::server {

// The widest path over confirmed edges, the shortest among those (core/graph/route.h).
// Throws ContractError no_such_map, no_such_vertex, no_route.
contract::Route find_route(Store& store, const std::string& map, std::uint32_t from, std::uint32_t to);

}  // namespace mapweld::server
