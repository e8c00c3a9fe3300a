// The command `mapweld-server check`.
#pragma once

namespace CLI {
class App;
}

namespace mapweld::server {

// Adds the subcommand; it runs when the command line is parsed. Throws CLI::RuntimeError with the exit code: 1 when
// something stored is damaged, 2 when the data folder could not be read.
void add_check_command(CLI::App& app);

}  // namespace mapweld::server
