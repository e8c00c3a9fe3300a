#include "server/http/caller.h"

#include <fnmatch.h>

namespace mapweld::server {

bool Caller::may_use(const std::string& map) const { return ::fnmatch(maps.c_str(), map.c_str(), FNM_NOESCAPE) == 0; }

}  // namespace mapweld::server
