#include "client/contract/vocabulary.h"
#include "server/api/api.h"
#include "server/api/openapi.h"
#include "server/api/replies.h"
#include "server/services/quotas.h"
#include "server/version.h"

namespace mapweld::server {

using contract::ContractError;

void add_system_routes(Router& router, const Services& services) {
  router.add(
      {.method = "GET", .pattern = "/healthz", .role = Role::kAnybody, .at_once = true, .handler = [](const Request&) {
         return json_reply(200, contract::Health{.status = "ok"});
       }});
  router.add({.method = "GET",
              .pattern = "/readyz",
              .role = Role::kAnybody,
              .handler = [ready = services.ready](const Request&) {
                if (!ready()) {
                  throw ContractError("not_ready",
                                      "The server has no vocabulary, its data folder is gone, or it is shutting down.");
                }
                return json_reply(200, contract::Health{.status = "ok"});
              }});
  router.add({.method = "GET", .pattern = "/version", .role = Role::kRead, .handler = [](const Request&) {
                return json_reply(200, contract::Version{.version = std::string(version())});
              }});
  router.add({.method = "GET",
              .pattern = "/metrics",
              .role = Role::kRead,
              .handler = [&metrics = services.metrics](const Request&) {
                Reply reply;
                reply.content_type = "text/plain; version=0.0.4; charset=utf-8";
                reply.body = metrics.prometheus_text();
                return reply;
              }});
  router.add({.method = "GET",
              .pattern = "/v1/quota",
              .role = Role::kRead,
              .handler = [&store = services.store](const Request& request) {
                return json_reply(200, quota_of(store.read(), request.caller.get()));
              }});
  router.add({.method = "GET", .pattern = "/v1/openapi.json", .role = Role::kRead, .handler = [](const Request&) {
                Reply reply;
                reply.content_type = "application/json";
                reply.body = openapi_document();
                return tagged_by_content(std::move(reply));
              }});
}

Router make_router(const Services& services) {
  Router router;
  add_system_routes(router, services);
  add_vocabulary_routes(router, services);
  add_map_routes(router, services);
  add_mask_routes(router, services);
  add_image_routes(router, services);
  add_removal_routes(router, services);
  add_merge_routes(router, services);
  add_event_routes(router, services);
  add_backup_routes(router, services);
  add_transfer_routes(router, services);
  return router;
}

}  // namespace mapweld::server
