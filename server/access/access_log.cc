#include "server/access/access_log.h"

#include <cmath>
#include <string>

#include <spdlog/spdlog.h>

#include "client/contract/json.h"
#include "server/log.h"

namespace mapweld::server {
namespace {

using contract::Json;

std::shared_ptr<spdlog::logger> logger_of(const std::string& name) {
  const auto logger = spdlog::get(name);
  return logger ? logger : spdlog::default_logger();
}

bool is_repeated_by_machines(const std::string& route) {
  return route == "/healthz" || route == "/readyz" || route == "/metrics";
}

spdlog::level::level_enum level_of(const FinishedRequest& request) {
  if (request.status == 500 || request.status == 507) return spdlog::level::warn;
  return is_repeated_by_machines(request.route) ? spdlog::level::debug : spdlog::level::info;
}

bool is_change(const FinishedRequest& request) {
  return request.role > Role::kRead && request.method != "GET" && request.method != "HEAD" && request.status >= 200 &&
         request.status < 300;
}

Json who(const char* event, const FinishedRequest& request) {
  return {{"event", event},
          {"request_id", request.request_id},
          {"key", request.caller ? request.caller->name : "-"},
          {"peer", request.peer},
          {"method", request.method.empty() ? "-" : request.method}};
}

}  // namespace

AccessLog::AccessLog(LogFormat format) : format_(format), access_(logger_of("access")), audit_(logger_of("audit")) {}

void AccessLog::tell(const FinishedRequest& request) const {
  const auto level = level_of(request);
  if (access_->should_log(level)) {
    Json event = who("request", request);
    event["route"] = request.route.empty() ? "-" : request.route;
    event["path"] = request.path.empty() ? "-" : request.path;
    event["status"] = request.status;
    event["elapsed_ms"] = std::round(request.elapsed_s * 1e5) / 100;
    event["bytes_in"] = request.bytes_in;
    event["bytes_out"] = request.bytes_out;
    access_->log(level, spdlog::string_view_t(log_line(event, format_)));
  }
  if (is_change(request)) {
    Json event = who("change", request);
    event["path"] = request.path;
    if (!request.subject.empty()) event["subject"] = request.subject;
    event["status"] = request.status;
    audit_->log(spdlog::level::info, spdlog::string_view_t(log_line(event, format_)));
  }
}

}  // namespace mapweld::server
