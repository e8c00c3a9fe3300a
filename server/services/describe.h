// From rows of the store to documents of the contract.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/contract/graph.h"
#include "client/contract/image.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_store.h"

namespace mapweld::server {

// `map`: name of the plain map that the vertex lives in.
contract::Vertex describe_vertex(const VertexRow& row, const std::string& map, std::int64_t degree);

contract::IgnoredImage describe_ignored(const ImageRow& row);

contract::Edge describe_edge(const EdgeRow& row);

}  // namespace mapweld::server
