#include <memory>
#include <string>
#include <utility>

#include "client/contract/vocabulary.h"
#include "server/api/api.h"
#include "server/api/description/contents.h"
#include "server/api/description/describe.h"
#include "server/api/replies.h"
#include "server/services/quotas.h"
#include "server/version.h"

namespace mapweld::server {

using contract::ContractError;

void add_system_routes(Router& router, const Services& services, std::shared_ptr<const std::string> description) {
  router.add({.method = "GET",
              .pattern = "/healthz",
              .role = Role::kAnybody,
              .at_once = true,
              .says = {.operation = "getHealth", .answers = {answers<contract::Health>(200)}},
              .handler = [](const Request&) { return json_reply(200, contract::Health{.status = "ok"}); }});
  router.add(
      {.method = "GET",
       .pattern = "/readyz",
       .role = Role::kAnybody,
       .says = {.operation = "getReadiness", .answers = {answers<contract::Health>(200)}, .codes = {"not_ready"}},
       .handler = [ready = services.ready](const Request&) {
         if (!ready()) {
           throw ContractError("not_ready",
                               "The server has no vocabulary, its data folder is gone, or it is shutting down.");
         }
         return json_reply(200, contract::Health{.status = "ok"});
       }});
  router.add({.method = "GET",
              .pattern = "/version",
              .role = Role::kRead,
              .says = {.operation = "getVersion", .answers = {answers<contract::Version>(200)}},
              .handler = [](const Request&) {
                return json_reply(200, contract::Version{.version = std::string(version())});
              }});
  router.add({.method = "GET",
              .pattern = "/metrics",
              .role = Role::kRead,
              .says = {.operation = "getMetrics", .answers = {{200, {{"text/plain"}}}}},
              .handler = [&metrics = services.metrics](const Request&) {
                Reply reply;
                reply.content_type = "text/plain; version=0.0.4; charset=utf-8";
                reply.body = metrics.prometheus_text();
                return reply;
              }});
  router.add({.method = "GET",
              .pattern = "/v1/quota",
              .role = Role::kRead,
              .says = {.operation = "getQuota", .answers = {answers<contract::Quota>(200)}},
              .handler = [&store = services.store](const Request& request) {
                return json_reply(200, quota_of(store.read(), request.caller.get()));
              }});
  router.add(
      {.method = "GET",
       .pattern = "/v1/openapi.json",
       .role = Role::kAnybody,
       .says = {.operation = "getDescription", .answers = {{200, {{"application/json"}}}, answers_not_modified()}},
       .handler = [description](const Request&) {
         Reply reply;
         reply.content_type = "application/json";
         reply.body = *description;
         return tagged_by_content(std::move(reply));
       }});
}

Router make_router(const Services& services) {
  Router router;
  const auto description = std::make_shared<std::string>();
  add_system_routes(router, services, description);
  add_docs_routes(router);
  add_vocabulary_routes(router, services);
  add_map_routes(router, services);
  add_mask_routes(router, services);
  add_image_routes(router, services);
  add_removal_routes(router, services);
  add_merge_routes(router, services);
  add_event_routes(router, services);
  add_backup_routes(router, services);
  add_transfer_routes(router, services);
  *description = openapi_text(describe_api(router.routes()).document);
  return router;
}

}  // namespace mapweld::server
