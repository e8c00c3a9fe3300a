// The server's log on standard error: lines for people, or a JSON document each.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace spdlog {
class formatter;
}

namespace mapweld::server {

enum class LogFormat : std::uint8_t { kText, kJson };

// Makes the default logger, "access" and "audit". `level`: trace, debug, info, warning, error, off. The audit log is
// told whatever the level is, but for off.
void set_up_log(const std::string& level, LogFormat format);

// {"time","level","message"}, or with the fields of the message where that is a JSON object already, as access lines
// are.
std::unique_ptr<spdlog::formatter> make_json_formatter();

}  // namespace mapweld::server
