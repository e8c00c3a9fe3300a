// From method and path to a handler.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/access/role.h"
#include "server/http/message.h"
#include "server/http/route_description.h"

namespace mapweld::server {

// What a route does with the body of a request.
enum class BodyRule : std::uint8_t {
  kNone,      // takes none
  kOptional,  // a missing Content-Length means that there is none
  kRequired,  // a missing length is 411
  kFile,      // as kRequired, and it is put into a file as it comes: Request::body_file
};

struct Route {
  std::string method;        // GET serves HEAD as well
  std::string pattern;       // "/v1/maps/{map}/vertices/{vertex}": {name} stands for one segment that is not empty
  Role role = Role::kAdmin;  // what a key must be good for
  BodyRule body = BodyRule::kNone;
  bool json_body = false;               // the body is a JSON document: the smaller limit holds
  std::vector<std::string> query = {};  // the query parameters that it knows
  bool at_once = false;  // the loop's thread calls the handler, which waits for nothing: it needs no other
  RouteDescription says = {};
  Handler handler = {};

  // What changes something takes an Idempotency-Key when it is a POST (docs/http-api.md, "Asking once").
  bool changes() const { return method != "GET" && role > Role::kRead; }
  bool takes_idempotency_key() const { return method == "POST" && changes(); }
};

// Immutable once the server runs; then any number of threads may match.
class Router {
 public:
  void add(Route route);

  struct Match {
    const Route* route = nullptr;                   // null: no route
    std::map<std::string, std::string> parameters;  // decoded
    std::string allow;                              // for the Allow field; empty: nothing under this path
  };
  // `path`: percent-encoded, without query. Segments are decoded after the split, so "%2F" does not separate.
  Match match(std::string_view method, std::string_view path) const;

  const std::vector<Route>& routes() const { return routes_; }

 private:
  std::vector<Route> routes_;
  std::vector<std::vector<std::string>> segments_;  // of each route's pattern
};

// Decodes %XX. False for a broken escape.
bool percent_decode(std::string_view encoded, std::string& decoded);

// "a=1&b=x%20y" -> values; "+" is a space. Throws ContractError malformed_request for a broken escape.
std::multimap<std::string, std::string> parse_query(std::string_view query);

}  // namespace mapweld::server
