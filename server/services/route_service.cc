#include "server/services/route_service.h"

#include <algorithm>
#include <optional>

#include "client/contract/problem.h"
#include "core/graph/appearance_graph.h"
#include "core/graph/route.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "server/services/describe.h"
#include "server/services/map_lookup.h"

namespace mapweld::server {

using contract::ContractError;

contract::Route find_route(Store& store, const std::string& map_name, std::uint32_t from, std::uint32_t to) {
  const ReadTransaction db = store.read();
  const MapRow map = require_map(db, map_name);
  const MapLayout layout = load_layout(db, map.id);
  for (const std::uint32_t vertex : {from, to}) require_vertex(db, map, layout, vertex);
  const AppearanceGraph graph(layout.vertices(), load_edges(db, layout, {.confirmed = true}));
  const std::optional<Route> route = widest_route(graph, VertexId{from}, VertexId{to});
  if (!route) {
    throw ContractError("no_route",
                        "No path leads from vertex " + std::to_string(from) + " to " + std::to_string(to) + ".");
  }
  contract::Route answer;
  for (const VertexId vertex : route->vertices) answer.vertices.push_back(to_index(vertex));
  for (std::size_t i = 1; i < route->vertices.size(); ++i) {
    const VertexId u = route->vertices[i - 1];
    const VertexId v = route->vertices[i];
    answer.edges.push_back(describe_edge(find_edge(db, layout, u, v).value()));
  }
  if (!answer.edges.empty()) answer.min_inliers = route->min_weight;
  return answer;
}

}  // namespace mapweld::server
