#include "client/contract/map.h"
#include "server/api/api.h"
#include "server/api/cursors.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/api/revision_tags.h"
#include "server/events/map_events.h"
#include "server/services/graph_export.h"
#include "server/services/pair_service.h"
#include "server/services/route_service.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

std::uint32_t vertex_in_query(const Request& request, const std::string& name) {
  const auto vertex = request.query.integer(name, 0, UINT32_MAX);
  if (!vertex) throw ContractError("invalid_parameter", "\"" + name + "\" is missing.");
  return static_cast<std::uint32_t>(*vertex);
}

std::optional<bool> inter_in_query(const Request& request) {
  const auto kind = request.query.text("kind");
  if (!kind) return std::nullopt;
  if (*kind != "inner" && *kind != "inter") {
    throw ContractError("invalid_parameter", "\"kind\" must be inner or inter.");
  }
  return *kind == "inter";
}

Reply stream_graph(Store& store, const Request& request) {
  const std::string word = request.query.text("format").value_or("json");
  const auto format = parse_graph_format(word);
  if (!format) throw ContractError("invalid_parameter", "\"format\" must be json, graphml, dot or csv.");
  Reply reply;
  reply.content_type = media_type(*format);
  reply.stream = export_graph(store, request.parameter("map"), *format);
  return reply;
}

}  // namespace

void add_map_routes(Router& router, const Services& services) {
  MapService& maps = services.maps;
  const RevisionTags tagged(services.store);
  const Cursors cursors(services.store);
  EventHub& events = services.events;
  router.add({.method = "POST",
              .pattern = "/v1/maps",
              .role = Role::kWrite,
              .body = BodyRule::kRequired,
              .json_body = true,
              .says = {.operation = "createMap",
                       .takes = {json_of<contract::CreateMap>()},
                       .answers = {answers<contract::Map>(201, {"Location"})},
                       .codes = {"invalid_name", "no_such_vocabulary", "name_taken", "not_ready"}},
              .handler = services.idempotency.once([&maps, &events](const Request& request, Once& once) {
                const auto map =
                    maps.create(contract::read_request<contract::CreateMap>(contract::parse_json(request.body)),
                                request.caller.get(),
                                once.keeps<contract::Map>([&](WriteTransaction& db, const contract::Map& made) {
                                  once.keep(db, map_made(made), made.name);
                                }));
                tell_map(events, map.name, "created");
                return map_made(map);
              })});
  router.add({.method = "GET",
              .pattern = "/v1/maps",
              .role = Role::kRead,
              .query = list_query(),
              .says = {.operation = "listMaps", .answers = {answers_page<contract::Map>()}},
              .handler = [&maps, cursors](const Request& request) {
                return cursors.reply(request,
                                     [&](const PageRequest& page) { return maps.list(page, request.caller.get()); });
              }});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}",
              .role = Role::kRead,
              .says = {.operation = "getMap", .answers = {answers<contract::Map>(200), answers_not_modified()}},
              .handler = tagged(
                  [&maps](const Request& request) { return json_reply(200, maps.get(request.parameter("map"))); })});
  router.add({.method = "PATCH",
              .pattern = "/v1/maps/{map}",
              .role = Role::kWrite,
              .body = BodyRule::kRequired,
              .json_body = true,
              .says = {.operation = "changeMap",
                       .takes = {json_of<contract::ChangeMap>()},
                       .answers = {answers<contract::Map>(200)},
                       .codes = {"invalid_name", "name_taken", "map_is_merged", "immutable_parameter"}},
              .handler = [&maps, &events](const Request& request) {
                const auto map =
                    maps.change(request.parameter("map"),
                                contract::read_request<contract::ChangeMap>(contract::parse_json(request.body)),
                                request.caller.get());
                tell_map(events, map.name, "changed");
                return json_reply(200, map);
              }});
  router.add({.method = "DELETE",
              .pattern = "/v1/maps/{map}",
              .role = Role::kWrite,
              .body = BodyRule::kOptional,
              .says = {.operation = "deleteMap", .answers = {answers_nothing()}, .codes = {"map_in_use"}},
              .handler = [&maps, &events](const Request& request) {
                maps.remove(request.parameter("map"));
                tell_map(events, request.parameter("map"), "deleted");
                return no_content();
              }});
  router.add(
      {.method = "GET",
       .pattern = "/v1/maps/{map}/vertices",
       .role = Role::kRead,
       .query = list_query({"name"}),
       .says = {.operation = "listVertices", .answers = {answers_page<contract::Vertex>(), answers_not_modified()}},
       .handler = tagged([&maps, cursors](const Request& request) {
         return cursors.reply(request, [&](const PageRequest& page) {
           return maps.vertices(request.parameter("map"), request.query.text("name"), page);
         });
       })});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/vertices/{vertex}",
              .role = Role::kRead,
              .says = {.operation = "getVertex", .answers = {answers<contract::Vertex>(200), answers_not_modified()}},
              .handler = tagged([&maps](const Request& request) {
                const auto vertex = number_in_path<std::uint32_t>(request, "vertex", "no_such_vertex");
                return json_reply(200, maps.vertex(request.parameter("map"), vertex));
              })});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/edges",
              .role = Role::kRead,
              .query = list_query({"min_inliers", "kind", "confirmed"}),
              .says = {.operation = "listEdges", .answers = {answers_page<contract::Edge>(), answers_not_modified()}},
              .handler = tagged([&maps, cursors](const Request& request) {
                MapService::EdgeQuery query;
                query.min_inliers =
                    static_cast<std::uint32_t>(request.query.integer("min_inliers", 0, 65535).value_or(0));
                query.inter = inter_in_query(request);
                query.confirmed = request.query.boolean("confirmed");
                return cursors.reply(request, [&](const PageRequest& page) {
                  return maps.edges(request.parameter("map"), query, page);
                });
              })});
  router.add(
      {.method = "GET",
       .pattern = "/v1/maps/{map}/graph",
       .role = Role::kRead,
       .query = {"format"},
       .says = {.operation = "getGraph",
                .answers =
                    {{200,
                      {json_of<contract::Graph>(), {"application/graphml+xml"}, {"text/vnd.graphviz"}, {"text/csv"}}},
                     answers_not_modified()}},
       .handler = tagged([&store = services.store](const Request& request) { return stream_graph(store, request); })});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/pairs/{u}/{v}",
              .role = Role::kRead,
              .query = {"matches"},
              .says = {.operation = "explainPair", .answers = {answers<contract::Pair>(200)}},
              .handler = [&store = services.store](const Request& request) {
                const VertexPair pair = pair_in_path(request);
                return json_reply(200,
                                  explain_pair(store, request.parameter("map"), pair.u, pair.v, pair.with_matches));
              }});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/quality",
              .role = Role::kRead,
              .says = {.operation = "getQuality", .answers = {answers<contract::Quality>(200), answers_not_modified()}},
              .handler = tagged([&quality = services.quality](const Request& request) {
                return json_reply(200, quality.quality(request.parameter("map")));
              })});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/route",
              .role = Role::kRead,
              .query = {"from", "to"},
              .says = {.operation = "findRoute",
                       .answers = {answers<contract::Route>(200), answers_not_modified()},
                       .codes = {"no_such_vertex", "no_route"}},
              .handler = tagged([&store = services.store](const Request& request) {
                const std::uint32_t from = vertex_in_query(request, "from");
                const std::uint32_t to = vertex_in_query(request, "to");
                return json_reply(200, find_route(store, request.parameter("map"), from, to));
              })});
}

}  // namespace mapweld::server
