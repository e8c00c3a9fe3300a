// Who may do what: keys and their roles, pages from elsewhere, rates. The Gate of a real server.
#pragma once

#include <string>
#include <vector>

#include "server/access/access_log.h"
#include "server/access/key_ring.h"
#include "server/access/rate_limiter.h"
#include "server/http/gate.h"

namespace mapweld::server {

struct AccessOptions {
  bool read_only = false;                         // nobody may change anything
  std::vector<std::string> cors_origins = {};     // pages that browsers may use the server from; "*": any
  Rate per_caller{.per_s = 500, .burst = 1'000};  // of a key; of an address where there are no keys
  Rate refused_per_address{.per_s = 10,
                           .burst = 50};  // requests without a key that is in force, where one is asked for
};

// What a request must pass, in this order:
// - a browser's page from elsewhere (Origin) may change nothing, unless it is one of `cors_origins`: 403;
// - where there are keys, one that is in force (401), with the route's role (403), for the map in the path (403);
// - its bucket's rate (429);
// - where nothing is changed, it must be a request that only looks (403 read_only).
// Where there are no keys, everybody may do everything; loopback then has no rate either.
class AccessGate final : public Gate {
 public:
  // `keys` must outlive this.
  AccessGate(KeyRing& keys, AccessOptions options, LogFormat format);

  Admission admit(const RequestHead& head) override;
  void finished(const FinishedRequest& request) noexcept override;

 private:
  bool is_allowed_origin(const std::string& origin) const;
  // Throws ContractError for what is refused.
  void check(const RequestHead& head, Admission& admission);
  void check_origin(const RequestHead& head) const;
  void check_purpose(const RequestHead& head) const;
  void check_rate(const std::string& who, const Rate& rate);
  Reply answer_preflight(const RequestHead& head) const;

  KeyRing& keys_;
  const AccessOptions options_;
  const AccessLog log_;
  RateLimiter limiter_;
};

}  // namespace mapweld::server
