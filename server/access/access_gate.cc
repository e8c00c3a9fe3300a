#include "server/access/access_gate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <spdlog/spdlog.h>

#include "client/contract/problem.h"
#include "server/access/addresses.h"
#include "server/access/key.h"
#include "server/http/problem.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr const char* kAsk =
    "This server asks for a key: send \"Authorization: Bearer KEY\" (mapweld: MAPWELD_KEY or --key). "
    "\"mapweld-server key create\" makes one.";
constexpr const char* kUnknown =
    "The key is not known here, or it was revoked. \"mapweld-server key list\" shows those in force.";

// What pages of other origins may send, beside what every page may.
constexpr const char* kRequestHeaders =
    "Authorization, Content-Type, Idempotency-Key, If-None-Match, Last-Event-ID, X-Request-Id";

class RateLimited final : public ContractError {
 public:
  RateLimited(const Rate& rate, long retry_after_s)
      : ContractError("rate_limited", "Too many requests from here: " + std::to_string(std::lround(rate.per_s)) +
                                          " a second are allowed. Ask again in " + std::to_string(retry_after_s) +
                                          " s."),
        retry_after_s_(retry_after_s) {}
  long retry_after_s() const { return retry_after_s_; }

 private:
  long retry_after_s_;
};

Reply refusal(const ContractError& error, const RequestHead& head) {
  Reply reply = problem_reply(contract::problem_of(error.code(), error.detail(), head.request_id));
  if (error.status() == 401) {
    const char* const reason = head.authorization.empty() ? "" : ", error=\"invalid_token\"";
    reply.headers.emplace_back("WWW-Authenticate", std::string("Bearer realm=\"mapweld\"") + reason);
  }
  if (const auto* limited = dynamic_cast<const RateLimited*>(&error)) {
    for (auto& [name, value] : reply.headers) {
      if (name == "Retry-After") value = std::to_string(limited->retry_after_s());
    }
  }
  return reply;
}

bool only_looks(const std::string& method) { return method == "GET" || method == "HEAD" || method == "OPTIONS"; }

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

AccessGate::AccessGate(KeyRing& keys, AccessOptions options, LogFormat format)
    : keys_(keys), options_(std::move(options)), log_(format) {}

Admission AccessGate::admit(const RequestHead& head) {
  Admission admission;
  if (is_allowed_origin(head.origin)) {
    admission.headers = {{"Access-Control-Allow-Origin", head.origin},
                         {"Access-Control-Expose-Headers",
                          "ETag, Idempotent-Replayed, Location, Retry-After, WWW-Authenticate, X-Request-Id"},
                         {"Vary", "Origin"}};
    if (head.method == "OPTIONS" && head.route == nullptr && !head.allow.empty()) {
      admission.reply = answer_preflight(head);
      return admission;
    }
  }
  try {
    check(head, admission);
    check_purpose(head);
  } catch (const ContractError& error) {
    admission.reply = refusal(error, head);
  }
  return admission;
}

void AccessGate::check(const RequestHead& head, Admission& admission) {
  check_origin(head);
  const Role needed = head.route ? head.route->role : Role::kRead;
  if (needed == Role::kAnybody) return;
  const auto key = bearer_key(head.authorization);
  KeyRing::Finding finding = keys_.find(key.value_or(""));
  if (!finding.has_keys) {
    if (!is_loopback_address(head.peer)) check_rate("address " + network_of(head.peer), options_.per_caller);
    return;
  }
  if (!finding.caller) {
    check_rate("refused " + network_of(head.peer), options_.refused_per_address);
    throw ContractError("unauthorized", head.authorization.empty() ? kAsk : kUnknown);
  }
  admission.caller = std::move(finding.caller);
  const Caller& caller = *admission.caller;
  check_rate("key " + caller.name, options_.per_caller);
  if (caller.role < needed) {
    throw ContractError("forbidden", "The key \"" + caller.name + "\" is of role " +
                                         std::string(to_string(caller.role)) + "; this takes " +
                                         std::string(to_string(needed)) + ". Use another key.");
  }
  if (const auto map = head.parameters.find("map"); map != head.parameters.end()) require_use(&caller, map->second);
}

void AccessGate::check_origin(const RequestHead& head) const {
  if (head.origin.empty() || only_looks(head.method) || is_same_origin(head.origin, head.host)) return;
  if (is_allowed_origin(head.origin)) return;
  throw ContractError("forbidden", "A page of " + head.origin +
                                       " may change nothing here. Start the server with --cors-origin to allow it.");
}

void AccessGate::check_purpose(const RequestHead& head) const {
  if (!options_.read_only || head.route == nullptr || !head.route->changes()) return;
  throw ContractError("read_only",
                      "This server changes nothing: it was started with --read-only. Ask the server that writes.");
}

void AccessGate::check_rate(const std::string& who, const Rate& rate) {
  const double wait_s = limiter_.take(who, rate, now_s());
  if (wait_s > 0) throw RateLimited(rate, static_cast<long>(std::ceil(wait_s)));
}

Reply AccessGate::answer_preflight(const RequestHead& head) const {
  Reply reply;
  reply.status = 204;
  reply.headers = {{"Access-Control-Allow-Methods", head.allow},
                   {"Access-Control-Allow-Headers", kRequestHeaders},
                   {"Access-Control-Max-Age", "600"}};
  return reply;
}

bool AccessGate::is_allowed_origin(const std::string& origin) const {
  if (origin.empty()) return false;
  return std::ranges::any_of(options_.cors_origins,
                             [&](const std::string& own) { return own == "*" || own == origin; });
}

void AccessGate::finished(const FinishedRequest& request) noexcept {
  try {
    log_.tell(request);
  } catch (const std::exception&) {
    // Nothing that could be logged.
  }
}

}  // namespace mapweld::server
