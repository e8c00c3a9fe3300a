// The command `mapweld-server purge`.
#pragma once

namespace CLI {
class App;
}

namespace mapweld::server {

// Adds the subcommand; it runs when the command line is parsed. Throws CLI::RuntimeError with the exit code: 2 when it
// could not be done.
void add_purge_command(CLI::App& app);

}  // namespace mapweld::server
