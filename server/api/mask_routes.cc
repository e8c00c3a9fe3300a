#include "server/api/api.h"
#include "server/api/replies.h"
#include "server/events/map_events.h"

namespace mapweld::server {

void add_mask_routes(Router& router, const Services& services) {
  constexpr const char* kPattern = "/v1/maps/{map}/mask";
  MaskService& masks = services.masks;
  EventHub& events = services.events;
  router.add({.method = "PUT",
              .pattern = kPattern,
              .role = Role::kWrite,
              .body = BodyRule::kRequired,
              .handler = [&masks, &events](const Request& request) {
                masks.set(request.parameter("map"), request.body_bytes());
                tell_map(events, request.parameter("map"), "mask");
                return no_content();
              }});
  router.add({.method = "GET", .pattern = kPattern, .role = Role::kRead, .handler = [&masks](const Request& request) {
                return image_reply(masks.get(request.parameter("map")));
              }});
  router.add({.method = "DELETE",
              .pattern = kPattern,
              .role = Role::kWrite,
              .body = BodyRule::kOptional,
              .handler = [&masks, &events](const Request& request) {
                masks.clear(request.parameter("map"));
                tell_map(events, request.parameter("map"), "mask");
                return no_content();
              }});
}

}  // namespace mapweld::server
