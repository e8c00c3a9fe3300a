#include "server/access/caller.h"

#include <fnmatch.h>

#include "client/contract/problem.h"

namespace mapweld::server {

bool Caller::may_use(const std::string& map) const { return ::fnmatch(maps.c_str(), map.c_str(), FNM_NOESCAPE) == 0; }

void require_use(const Caller* caller, const std::string& map) {
  if (caller == nullptr || caller->may_use(map)) return;
  throw contract::ContractError("forbidden", "The key \"" + caller->name + "\" is for maps named " + caller->maps +
                                                 "; \"" + map + "\" is not one. Use another key, or another name.");
}

}  // namespace mapweld::server
