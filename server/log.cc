#include "server/log.h"

#include <utility>

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "client/contract/json.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using contract::Json;

constexpr const char* kDefault = "mapweld";

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    const auto time = std::chrono::time_point_cast<std::chrono::microseconds>(message.time);
    const auto level = spdlog::level::to_string_view(message.level);
    Json head = {{"time", to_rfc3339(Timestamp(time.time_since_epoch()))},
                 {"level", std::string(level.data(), level.size())}};
    const std::string_view payload(message.payload.data(), message.payload.size());
    const bool is_document =
        payload.size() > 2 && payload.front() == '{' && payload.back() == '}' && message.logger_name != kDefault;
    if (!is_document) head["message"] = payload;
    std::string line = head.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (is_document) {
      line.back() = ',';
      line.append(payload.substr(1));
    }
    line += '\n';
    out.append(line.data(), line.data() + line.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

}  // namespace

std::string log_line(const Json& event, LogFormat format) {
  if (format == LogFormat::kJson) return event.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string line;
  for (const auto& [name, value] : event.items()) {
    if (!line.empty()) line += ' ';
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    line += name + '=' + (text.find(' ') == std::string::npos ? text : '"' + text + '"');
  }
  return line;
}

std::unique_ptr<spdlog::formatter> make_json_formatter() { return std::make_unique<JsonFormatter>(); }

void set_up_log(const std::string& level, LogFormat format) {
  const auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  const auto wanted = spdlog::level::from_str(level);
  for (const char* name : {kDefault, "access", "audit", "merges"}) {
    auto log = std::make_shared<spdlog::logger>(name, sink);
    log->set_level(name == std::string_view("audit") && wanted != spdlog::level::off
                       ? std::min(wanted, spdlog::level::info)
                       : wanted);
    log->flush_on(spdlog::level::info);
    spdlog::drop(name);
    if (name == std::string_view(kDefault)) {
      spdlog::set_default_logger(std::move(log));
    } else {
      spdlog::register_logger(std::move(log));
    }
  }
  if (format == LogFormat::kJson) {
    sink->set_formatter(make_json_formatter());
  } else {
    sink->set_formatter(
        std::make_unique<spdlog::pattern_formatter>("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc));
  }
}

}  // namespace mapweld::server
