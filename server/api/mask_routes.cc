#include "server/api/api.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/events/map_events.h"

namespace mapweld::server {

void add_mask_routes(Router& router, const Services& services) {
  constexpr const char* kPattern = "/v1/maps/{map}/mask";
  MaskService& masks = services.masks;
  EventHub& events = services.events;
  router.add(
      {.method = "PUT",
       .pattern = kPattern,
       .role = Role::kWrite,
       .body = BodyRule::kRequired,
       .says = {.operation = "setMask",
                .takes = {{"image/png"}},
                .answers = {answers_nothing()},
                .codes = {"map_is_merged", "image_too_large", "unsupported_image", "undecodable_image", "empty_mask"}},
       .handler = [&masks, &events](const Request& request) {
         masks.set(request.parameter("map"), request.body_bytes());
         tell_map(events, request.parameter("map"), "mask");
         return no_content();
       }});
  router.add(
      {.method = "GET",
       .pattern = kPattern,
       .role = Role::kRead,
       .says = {.operation = "getMask",
                .answers = {{200, {{"image/png"}}}, answers_not_modified()},
                .codes = {"no_such_mask"}},
       .handler = [&masks](const Request& request) { return image_reply(masks.get(request.parameter("map"))); }});
  router.add({.method = "DELETE",
              .pattern = kPattern,
              .role = Role::kWrite,
              .body = BodyRule::kOptional,
              .says = {.operation = "clearMask", .answers = {answers_nothing()}, .codes = {"map_is_merged"}},
              .handler = [&masks, &events](const Request& request) {
                masks.clear(request.parameter("map"));
                tell_map(events, request.parameter("map"), "mask");
                return no_content();
              }});
}

}  // namespace mapweld::server
