// The description of the API, OpenAPI 3.1: made from the routes, the contract's documents and its table of codes, with
// what words.json says of them.
#pragma once

#include <string>
#include <vector>

#include "client/contract/json.h"
#include "server/http/router.h"

namespace mapweld::server {

struct ApiDescription {
  contract::Json document;
  std::vector<std::string> faults;  // words that are missing or left over; a test wants none
};
ApiDescription describe_api(const std::vector<Route>& routes);

// The text of a document as it is served and kept (docs/openapi.json): what fits a line stands on one.
std::string openapi_text(const contract::Json& document);

}  // namespace mapweld::server
