// A line for every request that was answered, and one for every change: who, what, which map.
#pragma once

#include <memory>

#include "server/http/gate.h"
#include "server/log.h"

namespace spdlog {
class logger;
}

namespace mapweld::server {

// Thread-safe; lines go to the loggers "access" and "audit" of set_up_log, or to the default one without them.
class AccessLog {
 public:
  explicit AccessLog(LogFormat format);

  // Requests are told at `info`, those that machines repeat (health, metrics) at `debug`, failures of the server as
  // warnings. A change that was answered with 2xx is told a second time, to the audit log.
  void tell(const FinishedRequest& request) const;

 private:
  const LogFormat format_;
  const std::shared_ptr<spdlog::logger> access_;
  const std::shared_ptr<spdlog::logger> audit_;
};

}  // namespace mapweld::server
