// The program's version, from the build.
#pragma once

#include <string_view>

namespace mapweld::server {

inline std::string_view version() { return MAPWELD_VERSION; }

}  // namespace mapweld::server
