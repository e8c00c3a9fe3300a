#include "client/contract/merge.h"
#include "server/api/api.h"
#include "server/api/cursors.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/events/map_events.h"
#include "server/services/pair_service.h"

namespace mapweld::server {
namespace {

// Of a merge that the caller may use.
std::int64_t merge_in_path(const MergeService& merges, const Request& request) {
  const auto id = number_in_path<std::int64_t>(request, "merge", "no_such_merge");
  merges.require_use(id, request.caller.get());
  return id;
}

contract::RunMerge run_in(const Request& request) {
  if (request.body.empty()) return {};
  return contract::read_request<contract::RunMerge>(contract::parse_json(request.body));
}

// A merge that moves is worth asking about again.
Reply merge_reply(int status, const contract::Merge& merge) {
  Reply reply = json_reply(status, merge);
  reply.subject = merge.map + " of";
  for (const std::string& member : merge.maps) reply.subject += " " + member;
  if (!contract::is_at_rest(merge.state)) reply.headers.emplace_back("Retry-After", "1");
  return reply;
}

Reply commanded(const contract::Merge& merge) { return merge_reply(202, merge); }

Reply submitted(const contract::Merge& merge) {
  Reply reply = merge_reply(202, merge);
  reply.headers.emplace_back("Location", merge.links.self);
  return reply;
}

Keep<contract::Merge> kept_as(Once& once, Reply (*reply_of)(const contract::Merge&)) {
  return once.keeps<contract::Merge>([&once, reply_of](WriteTransaction& db, const contract::Merge& merge) {
    once.keep(db, reply_of(merge), merge.map);
  });
}

}  // namespace

void add_merge_routes(Router& router, const Services& services) {
  MergeService& merges = services.merges;
  const Cursors cursors(services.store);
  EventHub& events = services.events;
  router.add(
      {.method = "POST",
       .pattern = "/v1/merges",
       .role = Role::kOperate,
       .body = BodyRule::kRequired,
       .json_body = true,
       .says = {.operation = "submitMerge",
                .takes = {json_of<contract::SubmitMerge>()},
                .answers = {answers<contract::Merge>(202, {"Location", "Retry-After"})},
                .codes = {"invalid_name", "no_such_map", "name_taken", "vocabulary_mismatch", "wrong_state",
                          "duplicate_member", "too_few_members", "unknown_method", "invalid_budget", "quota_exceeded"}},
       .handler = services.idempotency.once([&merges, &events](const Request& request, Once& once) {
         const auto merge =
             merges.submit(contract::read_request<contract::SubmitMerge>(contract::parse_json(request.body)),
                           request.caller.get(), kept_as(once, submitted));
         tell_map(events, merge.map, "created");
         return submitted(merge);
       })});
  router.add({.method = "GET",
              .pattern = "/v1/merges",
              .role = Role::kRead,
              .query = list_query({"state"}),
              .says = {.operation = "listMerges", .answers = {answers_page<contract::Merge>()}},
              .handler = [&merges, cursors](const Request& request) {
                return cursors.reply(request, [&](const PageRequest& page) {
                  return merges.list(request.query.text("state"), page, request.caller.get());
                });
              }});
  router.add({.method = "GET",
              .pattern = "/v1/merges/{merge}",
              .role = Role::kRead,
              .says = {.operation = "getMerge", .answers = {answers<contract::Merge>(200, {"Retry-After"})}},
              .handler = [&merges](const Request& request) {
                return merge_reply(200, merges.get(merge_in_path(merges, request)));
              }});
  router.add({.method = "DELETE",
              .pattern = "/v1/merges/{merge}",
              .role = Role::kOperate,
              .body = BodyRule::kOptional,
              .says = {.operation = "deleteMerge", .answers = {answers_nothing()}, .codes = {"map_in_use"}},
              .handler = [&merges, &events](const Request& request) {
                const std::int64_t id = merge_in_path(merges, request);
                const std::string map = merges.get(id).map;
                merges.remove(id);
                tell_map(events, map, "deleted");
                return no_content();
              }});
  router.add({.method = "GET",
              .pattern = "/v1/merges/{merge}/curve",
              .role = Role::kRead,
              .query = list_query(),
              .says = {.operation = "listCurve", .answers = {answers_page<contract::CurvePoint>()}},
              .handler = [&merges, cursors](const Request& request) {
                const std::int64_t id = merge_in_path(merges, request);
                return cursors.reply(request, [&](const PageRequest& page) { return merges.curve(id, page); });
              }});
  router.add({.method = "GET",
              .pattern = "/v1/merges/{merge}/edges",
              .role = Role::kRead,
              .query = list_query(),
              .says = {.operation = "listMergeEdges", .answers = {answers_page<contract::MergeEdge>()}},
              .handler = [&merges, cursors](const Request& request) {
                const std::int64_t id = merge_in_path(merges, request);
                return cursors.reply(request, [&](const PageRequest& page) { return merges.edges(id, page); });
              }});
  router.add({.method = "POST",
              .pattern = "/v1/merges/{merge}/pause",
              .role = Role::kOperate,
              .body = BodyRule::kOptional,
              .json_body = true,
              .says = {.operation = "pauseMerge",
                       .answers = {answers<contract::Merge>(202, {"Retry-After"})},
                       .codes = {"wrong_state"}},
              .handler = services.idempotency.once([&merges](const Request& request, Once& once) {
                return commanded(merges.pause(merge_in_path(merges, request), kept_as(once, commanded)));
              })});
  router.add({.method = "POST",
              .pattern = "/v1/merges/{merge}/resume",
              .role = Role::kOperate,
              .body = BodyRule::kOptional,
              .json_body = true,
              .says = {.operation = "resumeMerge",
                       .takes = {json_of<contract::RunMerge>()},
                       .answers = {answers<contract::Merge>(202, {"Retry-After"})},
                       .codes = {"wrong_state", "nothing_to_resume", "invalid_budget", "quota_exceeded"}},
              .handler = services.idempotency.once([&merges](const Request& request, Once& once) {
                return commanded(merges.resume(merge_in_path(merges, request), run_in(request),
                                               kept_as(once, commanded), request.caller.get()));
              })});
  router.add({.method = "POST",
              .pattern = "/v1/merges/{merge}/restart",
              .role = Role::kOperate,
              .body = BodyRule::kOptional,
              .json_body = true,
              .says = {.operation = "restartMerge",
                       .takes = {json_of<contract::RunMerge>()},
                       .answers = {answers<contract::Merge>(202, {"Retry-After"})},
                       .codes = {"map_in_use", "wrong_state", "invalid_budget", "quota_exceeded"}},
              .handler = services.idempotency.once([&merges](const Request& request, Once& once) {
                return commanded(merges.restart(merge_in_path(merges, request), run_in(request),
                                                kept_as(once, commanded), request.caller.get()));
              })});
  router.add({.method = "POST",
              .pattern = "/v1/merges/{merge}/cancel",
              .role = Role::kOperate,
              .body = BodyRule::kOptional,
              .json_body = true,
              .says = {.operation = "cancelMerge",
                       .answers = {answers<contract::Merge>(202, {"Retry-After"})},
                       .codes = {"wrong_state"}},
              .handler = services.idempotency.once([&merges](const Request& request, Once& once) {
                return commanded(merges.cancel(merge_in_path(merges, request), kept_as(once, commanded)));
              })});
  router.add({.method = "GET",
              .pattern = "/v1/merges/{merge}/pairs/{u}/{v}",
              .role = Role::kRead,
              .query = {"matches"},
              .says = {.operation = "explainMergePair", .answers = {answers<contract::Pair>(200)}},
              .handler = [&merges, &store = services.store](const Request& request) {
                const VertexPair pair = pair_in_path(request);
                return json_reply(
                    200, explain_pair(store, merge_in_path(merges, request), pair.u, pair.v, pair.with_matches));
              }});
}

}  // namespace mapweld::server
