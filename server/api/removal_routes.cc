#include "client/contract/image.h"
#include "server/api/api.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/events/map_events.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

std::uint32_t vertex_in_path(const Request& request) {
  return number_in_path<std::uint32_t>(request, "vertex", "no_such_vertex");
}

// Those that the query names: all of them is nothing that one says by leaving something out.
std::int64_t remove_in_query(RemovalService& removals, const Request& request) {
  const std::string& map = request.parameter("map");
  const auto name = request.query.text("name");
  const auto from = request.query.integer("from", 0, UINT32_MAX), to = request.query.integer("to", 0, UINT32_MAX);
  if (name && !from && !to) return removals.remove_named(map, *name);
  if (!name && from && to) {
    return removals.remove_range(map, static_cast<std::uint32_t>(*from), static_cast<std::uint32_t>(*to));
  }
  throw ContractError("invalid_parameter", "Say which: by \"name\", or by \"from\" and \"to\".");
}

}  // namespace

void add_removal_routes(Router& router, const Services& services) {
  RemovalService& removals = services.removals;
  EventHub& events = services.events;
  router.add({.method = "DELETE",
              .pattern = "/v1/maps/{map}/vertices",
              .role = Role::kWrite,
              .body = BodyRule::kOptional,
              .query = {"name", "from", "to"},
              .says = {.operation = "deleteVertices",
                       .answers = {answers<contract::Deleted>(200)},
                       .codes = {"no_such_vertex", "map_in_use", "map_is_merged"}},
              .handler = [&removals, &events](const Request& request) {
                const std::int64_t deleted = remove_in_query(removals, request);
                if (deleted > 0) tell_map(events, request.parameter("map"), "images");
                return json_reply(200, contract::Deleted{deleted});
              }});
  router.add({.method = "DELETE",
              .pattern = "/v1/maps/{map}/vertices/{vertex}",
              .role = Role::kWrite,
              .body = BodyRule::kOptional,
              .says = {.operation = "deleteVertex",
                       .answers = {answers<contract::Deleted>(200)},
                       .codes = {"map_in_use", "map_is_merged"}},
              .handler = [&removals, &events](const Request& request) {
                const std::int64_t deleted = removals.remove(request.parameter("map"), vertex_in_path(request));
                tell_map(events, request.parameter("map"), "images");
                return json_reply(200, contract::Deleted{deleted});
              }});
  router.add({.method = "DELETE",
              .pattern = "/v1/maps/{map}/vertices/{vertex}/image",
              .role = Role::kWrite,
              .body = BodyRule::kOptional,
              .says = {.operation = "deleteImage", .answers = {answers_nothing()}, .codes = {"map_is_merged"}},
              .handler = [&removals, &events](const Request& request) {
                removals.remove_image(request.parameter("map"), vertex_in_path(request));
                tell_map(events, request.parameter("map"), "images");
                return no_content();
              }});
  router.add({.method = "POST",
              .pattern = "/v1/maps/{map}/vertices/{vertex}/restore",
              .role = Role::kWrite,
              .body = BodyRule::kOptional,
              .says = {.operation = "restoreVertex",
                       .answers = {answers<contract::Vertex>(200)},
                       .codes = {"map_in_use", "map_is_merged", "quota_exceeded"}},
              .handler = services.idempotency.once(
                  [&removals, &events, &maps = services.maps](const Request& request, Once& once) {
                    const std::string& map = request.parameter("map");
                    const std::uint32_t vertex = vertex_in_path(request);
                    removals.restore(map, vertex, once.keeps<VertexId>([&](WriteTransaction& db, VertexId) {
                      once.keep(db, json_reply(200, maps.vertex(db, map, vertex)), map);
                    }),
                                     request.caller.get());
                    tell_map(events, map, "images");
                    return json_reply(200, maps.vertex(map, vertex));
                  })});
}

}  // namespace mapweld::server
