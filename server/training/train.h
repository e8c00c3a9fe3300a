// The command `mapweld-server train`: a vocabulary from folders of images.
#pragma once

namespace CLI {
class App;
}

namespace mapweld {

// Adds the subcommand `train` to `app`; it runs when the command line is parsed. Throws CLI::RuntimeError with the exit
// code (CLI::App::exit returns it): 1 when training failed, 130 when it was interrupted.
void add_train_command(CLI::App& app);

}  // namespace mapweld
