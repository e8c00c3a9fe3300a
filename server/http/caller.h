// Who a request comes from, as the gate found.
#pragma once

#include <string>

namespace mapweld::server {

struct Caller {
  std::string name;        // of the key
  std::string maps = "*";  // a pattern (fnmatch) of the maps that it may use

  bool may_use(const std::string& map) const;
};

}  // namespace mapweld::server
