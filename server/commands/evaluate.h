// The command `mapweld-server evaluate`.
#pragma once

namespace CLI {
class App;
}

namespace mapweld::server {

// Adds the subcommand; it runs when the command line is parsed. Throws CLI::RuntimeError with the exit code 1 when the
// evaluation cannot be made: an unknown map or method, a truth file that cannot be read, a folder that cannot be
// written.
void add_evaluate_command(CLI::App& app);

}  // namespace mapweld::server
