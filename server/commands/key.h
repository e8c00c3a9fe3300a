// mapweld-server key create, list, revoke
#pragma once

#include <CLI/CLI.hpp>

namespace mapweld::server {

// Exit codes: 0 done, 1 refused (the name is taken, no such key), 2 the folder cannot be read or written.
void add_key_command(CLI::App& app);

}  // namespace mapweld::server
