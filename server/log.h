// The server's log on standard error: lines for people, or a JSON document each.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "client/contract/json.h"

namespace spdlog {
class formatter;
}

namespace mapweld::server {

enum class LogFormat : std::uint8_t { kText, kJson };

// The fields of what happened as a line: event=request request_id=..., or the document; the same names in both.
std::string log_line(const contract::Json& event, LogFormat format);

// Makes the default logger, and for such lines "access", "audit" and "merges". `level`: trace, debug, info, warning,
// error, off. The audit log is told whatever the level is, but for off.
void set_up_log(const std::string& level, LogFormat format);

// {"time","level","message"}, or with the fields of the message where that is a line of log_line.
std::unique_ptr<spdlog::formatter> make_json_formatter();

}  // namespace mapweld::server
