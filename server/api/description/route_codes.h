// What can go wrong with a request of a route.
#pragma once

#include <vector>

#include "client/contract/problem.h"
#include "server/http/router.h"

namespace mapweld::server {

// The route's own codes and those that follow from its role, path, query and body; each once, in the order of kCodes.
std::vector<contract::Code> codes_of(const Route& route);

}  // namespace mapweld::server
