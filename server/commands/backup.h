// The commands `mapweld-server backup` and `mapweld-server restore`.
#pragma once

namespace CLI {
class App;
}

namespace mapweld::server {

// Adds the subcommands; they run when the command line is parsed. Throw CLI::RuntimeError with the exit code: 1 when a
// restored backup is damaged, 2 when something could not be read or written.
void add_backup_commands(CLI::App& app);

}  // namespace mapweld::server
