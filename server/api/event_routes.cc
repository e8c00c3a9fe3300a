#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "server/api/api.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/events/merge_events.h"

namespace mapweld::server {
namespace {

// Of each event the caller hears that may use its maps.
EventHub::Filter filter_of(const Request& request) {
  if (!request.caller) return {};
  return [caller = request.caller](const Event& event) {
    return std::all_of(event.maps.begin(), event.maps.end(),
                       [&](const std::string& map) { return caller->may_use(map); });
  };
}

Reply stream_of(std::shared_ptr<EventStream> events) {
  Reply reply;
  reply.content_type = "text/event-stream";
  reply.headers.emplace_back("Cache-Control", "no-store");
  reply.events = std::move(events);
  return reply;
}

}  // namespace

void add_event_routes(Router& router, const Services& services) {
  EventHub& events = services.events;
  router.add({.method = "GET",
              .pattern = "/v1/events",
              .role = Role::kRead,
              .says = {.operation = "hearAll", .answers = {{200, {{"text/event-stream"}}}}},
              .handler = [&events](const Request& request) {
                return stream_of(events.listen(filter_of(request), {}, request.last_event_id));
              }});
  router.add({.method = "GET",
              .pattern = "/v1/merges/{merge}/events",
              .role = Role::kRead,
              .says = {.operation = "hearMerge", .answers = {{200, {{"text/event-stream"}}}}},
              .handler = [&events, &merges = services.merges](const Request& request) {
                const auto id = number_in_path<std::int64_t>(request, "merge", "no_such_merge");
                merges.require_use(id, request.caller.get());
                const contract::Merge merge = merges.get(id);
                return stream_of(
                    events.listen(filter_of(request), merge.id, request.last_event_id, standing_of(merge)));
              }});
}

}  // namespace mapweld::server
