// Who a request comes from, as the gate found.
#pragma once

#include <cstdint>
#include <string>

#include "schema/key_store.h"
#include "server/access/role.h"

namespace mapweld::server {

struct Caller {
  std::int64_t id = 0;  // of the key, never another's; 0: none
  std::string name;     // of the key
  Role role = Role::kRead;
  KeyQuota quota = {};
  std::string maps = "*";  // a pattern (fnmatch) of the maps that it may use

  bool may_use(const std::string& map) const;
};

// Throws ContractError forbidden when the caller may not use a map of this name. Null: nobody was asked, all may be
// used.
void require_use(const Caller* caller, const std::string& map);

// Whether there is any map that the caller may not use.
inline bool sees_all(const Caller* caller) { return caller == nullptr || caller->maps == "*"; }

}  // namespace mapweld::server
