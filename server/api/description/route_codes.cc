#include "server/api/description/route_codes.h"

#include <algorithm>
#include <string>
#include <utility>

namespace mapweld::server {

using contract::Code;

std::vector<Code> codes_of(const Route& route) {
  std::vector<Code> found = route.says.codes;
  const auto add = [&](bool applies, std::initializer_list<Code> codes) {
    if (applies) found.insert(found.end(), codes);
  };
  const auto has = [&](const char* parameter) {
    return route.pattern.find("{" + std::string(parameter) + "}") != std::string::npos;
  };
  const auto answers = [&](int status) {
    return std::ranges::any_of(route.says.answers, [&](const auto& answer) { return answer.status == status; });
  };
  add(true, {"malformed_request", "unknown_field", "request_timeout", "uri_too_long", "unknown_host",
             "headers_too_large", "internal_error", "shutting_down", "busy"});
  add(route.role != Role::kAnybody, {"unauthorized", "forbidden", "rate_limited"});
  add(route.role != Role::kAnybody && route.method != "GET", {"no_space"});
  add(route.changes(), {"read_only"});
  add(route.takes_idempotency_key(), {"invalid_parameter", "idempotency_in_progress", "idempotency_mismatch"});
  add(has("map"), {"no_such_map"});
  add(has("vertex") || has("u"), {"no_such_vertex"});
  add(has("vocabulary"), {"no_such_vocabulary"});
  add(has("merge"), {"no_such_merge"});
  add(has("backup"), {"no_such_backup"});
  add(!route.query.empty(), {"invalid_parameter"});
  add(answers(206), {"range_not_satisfiable"});
  const bool must_have_body = route.body == BodyRule::kRequired || route.body == BodyRule::kFile;
  add(route.body != BodyRule::kNone, {"body_too_large", "unsupported_media_type"});
  add(must_have_body, {"length_required", "empty_body"});
  add(route.json_body && !route.says.takes.empty(), {"malformed_json", "invalid_parameter"});

  std::vector<Code> codes;
  for (const contract::CodeEntry& entry : contract::kCodes) {
    const Code code = Code::find(entry.code);
    if (std::ranges::find(found, code) != found.end()) codes.push_back(code);
  }
  return codes;
}

}  // namespace mapweld::server
