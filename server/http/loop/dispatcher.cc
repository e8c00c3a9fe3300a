#include "server/http/loop/dispatcher.h"

#include <algorithm>
#include <exception>
#include <string_view>
#include <utility>

#include "client/contract/problem.h"
#include "server/http/problem.h"
#include "server/http/wire/compression.h"
#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

bool is_request_id(std::string_view id) {
  return !id.empty() && id.size() <= 64 && std::all_of(id.begin(), id.end(), [](char c) {
    return is_alphanumeric(c) || c == '-' || c == '_' || c == '.';
  });
}

Reply problem_of_current(const std::string& request_id) {
  return problem_reply(problem_of(std::current_exception(), request_id));
}

// Sends no more than the client asks for: nothing of what it has, gzip where it takes that.
void negotiate(const Request& request, Reply& reply) {
  const bool compressible = is_compressible(reply.content_type);
  if (compressible) reply.headers.emplace_back("Vary", "Accept-Encoding");
  if (!reply.etag.empty() && request.knows(reply.etag)) {
    reply.status = 304;
    reply.content_type.clear();
    reply.body.clear();
    reply.stream = {};
    reply.stream_bytes.reset();
  } else if (compressible && request.accepts_gzip) {
    compress(reply);
  }
  if (reply.etag.empty()) return;
  reply.headers.emplace_back("ETag", reply.etag);
  reply.headers.emplace_back("Cache-Control", "private, no-cache");  // kept, and asked about each time
}

}  // namespace

Dispatcher::Dispatcher(const HttpOptions& options, Router router, Gate* gate)
    : hosts_(options.host, options.allowed_hosts),
      max_body_bytes_(options.max_body_bytes),
      max_json_bytes_(std::min(options.max_json_bytes, options.max_body_bytes)),
      max_file_bytes_(options.max_file_bytes),
      router_(std::move(router)),
      gate_(gate) {}

Plan Dispatcher::plan(const Head& head, const std::string& request_id, const std::string& peer) const {
  Plan plan;
  const std::string own_id = head.field("x-request-id");
  plan.head = {.request_id = is_request_id(own_id) ? own_id : request_id,
               .method = head.method,
               .path = head.target.substr(0, head.target.find('?')),
               .allow = {},
               .parameters = {},
               .authorization = head.field("authorization"),
               .origin = head.field("origin"),
               .host = head.field("host"),
               .content_type = head.field("content-type"),
               .peer = peer};
  try {
    consider(head, plan);
  } catch (...) {
    plan.refusal = problem_of_current(plan.head.request_id);
  }
  return plan;
}

Reply Dispatcher::answer(const Plan& plan) {
  try {
    Reply reply = plan.head.route->handler(plan.request);
    negotiate(plan.request, reply);
    return reply;
  } catch (...) {
    return problem_of_current(plan.head.request_id);
  }
}

void Dispatcher::consider(const Head& head, Plan& plan) const {
  RequestHead& known = plan.head;
  if (!known.host.empty() && !hosts_.know(known.host)) {
    throw ContractError("unknown_host", "This server is not known as \"" + known.host +
                                            "\". Ask it by its address, or start it with --allowed-host.");
  }
  Router::Match match = router_.match(known.method, known.path);
  known.route = match.route;
  known.allow = match.allow;
  known.parameters = match.parameters;
  if (gate_) {
    plan.admission = gate_->admit(known);
    if (plan.admission.reply) {
      plan.refusal = std::move(plan.admission.reply);
      return;
    }
  }
  if (!match.route) {
    if (match.allow.empty()) throw ContractError("no_such_path", "There is nothing under " + known.path + ".");
    plan.refusal = problem_reply(contract::problem_of(
        "method_not_allowed", known.path + " answers " + match.allow + " only.", known.request_id));
    if (known.method == "OPTIONS") {
      plan.refusal.emplace();
      plan.refusal->status = 204;
    }
    plan.refusal->headers.emplace_back("Allow", match.allow);
    return;
  }
  Request& request = plan.request;
  request.method = known.method;
  request.path = known.path;
  request.parameters = std::move(match.parameters);
  const std::string_view target = head.target;
  request.query = Query(parse_query(target.substr(std::min(known.path.size() + 1, target.size()))));
  request.query.refuse_unknown(match.route->query);
  request.content_type = known.content_type;
  request.last_event_id = head.field("last-event-id");
  request.if_none_match = head.field("if-none-match");
  request.accepts_gzip = accepts_gzip(head.field("accept-encoding"));
  request.range = head.field("range");
  request.if_range = head.field("if-range");
  if (head.has("idempotency-key")) request.idempotency_key = head.field("idempotency-key");
  request.request_id = known.request_id;
  request.caller = plan.admission.caller;
  consider_body(head, plan);
}

void Dispatcher::consider_body(const Head& head, Plan& plan) const {
  const Route& route = *plan.head.route;
  if (route.body == BodyRule::kNone) return;
  const std::string encoding = lower(head.field("content-encoding"));
  if (!encoding.empty() && encoding != "identity") {
    throw ContractError("unsupported_media_type", "Content-Encoding is not supported: send the bytes as they are.");
  }
  if (head.framing == Framing::kNone && (route.body == BodyRule::kRequired || route.body == BodyRule::kFile)) {
    throw ContractError("length_required", "The request has neither Content-Length nor chunked Transfer-Encoding.");
  }
  plan.takes_body = head.framing != Framing::kNone;
  plan.max_body_bytes = route.body == BodyRule::kFile ? max_file_bytes_
                        : route.json_body             ? max_json_bytes_
                                                      : max_body_bytes_;
}

}  // namespace mapweld::server
